#pragma once

#include <map>
#include <string>

#include "backend/graph/situational_graph.h"
#include "backend/output/session_clock.h"

namespace sgraphs {

// graph.json of contract.md (schema sgraphs/1). Links between keyframes also carry their measurement:
// "T_source_target" and "covariance", the 21 entries of the upper triangle row by row, of the right
// perturbation (translation [m], rotation [rad]) in the target's body frame. A keyframe whose marginal
// covariance of T_map_body (tangent of body, given the first keyframe) is known has it in the same form.
// `sessions`: of a map that was continued; times are then those of the recordings, and keyframes and rooms
// carry the number of their session. Walls state their tilts as turns about their axes (docs/frames.md,
// "Planes").
std::string graphJson(const SituationalGraph& graph, const std::map<FloorId, FloorNode>& floors,
                      const std::map<KeyframeId, Matrix6d>& keyframe_covariances = {},
                      std::span<const SessionClock> sessions = {});

// graph.g2o for stock g2o: VERTEX_SE3:QUAT, VERTEX_PLANE, FIX of the first keyframe, EDGE_SE3:QUAT,
// EDGE_SE3_PLANE_CALIB. Keyframes have their own number as id; ids of planes and of the sensor offsets that
// a calibration edge needs follow after (a comment in the file says how).
std::string graphG2o(const SituationalGraph& graph);

}  // namespace sgraphs
