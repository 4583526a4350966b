#pragma once

#include <string>
#include <vector>

#include "backend/graph/situational_graph.h"

namespace sgraphs {

// Why the measurement cannot be solved with, whatever it is of; empty if it can.
std::string faultOfMeasurement(const RelativePose& z);

// What of an arriving keyframe may enter the graph.
struct Admission {
  bool accepted = false;                     // the keyframe itself
  std::vector<RelativePose> relative_poses;  // sound, between known keyframes; one may be a bridge
  bool has_up = false;
  bool bridged = false;              // no odometry or neighbour measurement held it to the graph
  std::vector<std::string> refused;  // one line for each thing refused: what and why
};

// Nothing that is not finite, not a rotation, out of order, or of unknown keyframes passes. A keyframe that
// no sound odometry or neighbour measurement ties to the graph (its predecessor was lost, say) is bridged
// from the newest keyframe by the odom poses of the two, with the covariance of bridgeCovariance().
Admission admit(const Keyframe& keyframe, const SituationalGraph& graph);

// Nobody measured the uncertainty of a bridge: 5 cm + 10 % of the distance and 20 mrad + 10 % of the turn
// (one sigma per axis), several times what legs or LiDAR odometry do over such a gap.
Matrix6d bridgeCovariance(const SE3& T_from_to);

}  // namespace sgraphs
