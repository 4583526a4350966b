#pragma once

#include <span>
#include <vector>

#include "backend/graph/situational_graph.h"
#include "common/io/tum.h"

namespace sgraphs {

// T_map_body of every scan: the odometry moved by the map's correction T_map_odom = T_map_kf * T_odom_kf^-1
// of the keyframes around it, blended in time along a constant twist. At a keyframe's instant this is the
// optimised keyframe; before the first and after the last keyframe the nearest correction holds. Without a
// keyframe map and odom coincide.
std::vector<StampedPose> denseTrajectory(const SituationalGraph& graph,
                                         std::span<const OdometryEstimate> scans);

// T_map_body of every keyframe, in order of time.
std::vector<StampedPose> keyframeTrajectory(const SituationalGraph& graph);

// T_odom_body of every scan.
std::vector<StampedPose> odometryTrajectory(std::span<const OdometryEstimate> scans);

}  // namespace sgraphs
