#include "drivers/spot/body_state.h"

namespace sgraphs {

BodyStateResult bodyStateIn(const RobotState& state, const std::string& frame) {
  if (state.acquired_robot.us <= 0) return {std::nullopt, "no acquisition time"};
  const FrameLookup lookup = findTransform(state.frames, frame, "body");
  if (!lookup.T_dst_src) return {std::nullopt, lookup.error};
  BodyState body{state.acquired_robot, *lookup.T_dst_src, std::nullopt};
  if (const auto velocity = state.body_velocity.find(frame); velocity != state.body_velocity.end()) {
    const Eigen::Quaterniond q_body_frame = body.T_frame_body.rotation.conjugate();
    Vector6d twist_body;
    twist_body << q_body_frame * velocity->second.linear_mps, q_body_frame * velocity->second.angular_radps;
    if (!twist_body.allFinite()) return {std::nullopt, "the velocity in frame '" + frame + "' is not finite"};
    body.twist_body = twist_body;
  }
  return {body, ""};
}

}  // namespace sgraphs
