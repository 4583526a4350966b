#include "drivers/spot/body_state.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sgraphs {
namespace {

const SE3 kTOdomWalking(so3Exp({0.2, 0.1, 1.0}), {1, 2, 0.5});

RobotState walkingState() {
  RobotState state;
  state.acquired_robot = {1'000'000};
  state.frames = {{"body", {"", {}}}, {"odom", {"body", kTOdomWalking.inverse()}}};
  return state;
}

TEST(BodyStateTest, VelocityIsTurnedIntoTheBody) {
  // Half a metre per second forward and left turn, as the body feels them, told in axes of odom.
  const Eigen::Vector3d forward_body(0.5, 0, 0), turn_body(0, 0, 0.3);
  RobotState state = walkingState();
  state.body_velocity["odom"] = {kTOdomWalking.rotation * forward_body, kTOdomWalking.rotation * turn_body};
  const BodyStateResult result = bodyStateIn(state, "odom");
  ASSERT_TRUE(result.state);
  EXPECT_LT(se3Log(result.state->T_frame_body.inverse() * kTOdomWalking).norm(), 1e-12);
  ASSERT_TRUE(result.state->twist_body);
  EXPECT_LT((result.state->twist_body->head<3>() - forward_body).norm(), 1e-12);
  EXPECT_LT((result.state->twist_body->tail<3>() - turn_body).norm(), 1e-12);
  EXPECT_EQ(result.state->acquired_robot, Time{1'000'000});
}

TEST(BodyStateTest, TheTwistAgreesWithTheMotionOfThePose) {
  // A pose a moment later, by the twist on the right, moves in odom as the told velocity does.
  RobotState state = walkingState();
  const Eigen::Vector3d linear_odom(0.3, -0.4, 0.1);
  state.body_velocity["odom"] = {linear_odom, {0, 0, 0.7}};
  const BodyState body = *bodyStateIn(state, "odom").state;
  constexpr double kDt_s = 1e-5;
  const SE3 later = body.T_frame_body * se3Exp(*body.twist_body * kDt_s);
  EXPECT_LT(((later.translation - body.T_frame_body.translation) / kDt_s - linear_odom).norm(), 1e-4);
}

TEST(BodyStateTest, VelocityInAnotherFrameIsNotTakenForThisOnes) {
  RobotState state = walkingState();
  state.body_velocity["vision"] = {{1, 0, 0}, {0, 0, 0}};
  const BodyStateResult result = bodyStateIn(state, "odom");
  ASSERT_TRUE(result.state);
  EXPECT_FALSE(result.state->twist_body);
}

TEST(BodyStateTest, ContentThatCannotBeRightIsRefused) {
  RobotState state = walkingState();
  EXPECT_EQ(bodyStateIn(state, "vision").refused, "no frame 'vision'");
  state.body_velocity["odom"] = {{NAN, 0, 0}, {0, 0, 0}};
  EXPECT_EQ(bodyStateIn(state, "odom").refused, "the velocity in frame 'odom' is not finite");
  state = walkingState();
  state.acquired_robot = {0};
  EXPECT_EQ(bodyStateIn(state, "odom").refused, "no acquisition time");
}

}  // namespace
}  // namespace sgraphs
