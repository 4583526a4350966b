#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/base/time.h"
#include "drivers/spot/frame_tree.h"

namespace sgraphs {

// What a robot's state says, as it says it.
struct RobotState {
  struct Velocity {
    Eigen::Vector3d linear_mps = Eigen::Vector3d::Zero();
    Eigen::Vector3d angular_radps = Eigen::Vector3d::Zero();
  };
  Time acquired_robot;  // in the robot's clock; 0: not given
  FrameTree frames;
  std::map<std::string, Velocity> body_velocity;  // of body, by the frame in whose axes it is expressed
};

// Body at one instant.
struct BodyState {
  Time acquired_robot;  // in the robot's clock
  SE3 T_frame_body;
  std::optional<Vector6d> twist_body;  // [m/s, rad/s] in axes of body; nothing if the robot gave none
};

// A body's state, or why it is refused: one line.
struct BodyStateResult {
  std::optional<BodyState> state;
  std::string refused;
};

// Pose of body in `frame`, and its velocity turned from the axes of `frame` into those of body.
BodyStateResult bodyStateIn(const RobotState& state, const std::string& frame);

}  // namespace sgraphs
