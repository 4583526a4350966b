#pragma once

#include <map>
#include <string>

#include "backend/graph/situational_graph.h"

namespace sgraphs {

// graph.json of contract.md (schema sgraphs/1). Links between keyframes also carry their measurement:
// "T_source_target" and "covariance", the 21 entries of the upper triangle row by row, of the right
// perturbation (translation [m], rotation [rad]) in the target's body frame.
std::string graphJson(const SituationalGraph& graph, const std::map<FloorId, FloorNode>& floors);

// graph.g2o for stock g2o: VERTEX_SE3:QUAT, FIX of the first keyframe, EDGE_SE3:QUAT.
// g2o's error is (translation, vector part of the unit quaternion) of Z^-1 Xi^-1 Xj: its rotation coordinates
// are half our angles, so each rotation row and column of the information is doubled.
std::string graphG2o(const SituationalGraph& graph);

}  // namespace sgraphs
