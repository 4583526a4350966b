#include "perception/relocalise/relocaliser.h"

#include <gtest/gtest.h>

#include "tests/perception/loops/loop_world.h"

namespace sgraphs {
namespace {

using test::LoopWalk;

constexpr double kTurn_rad = 137 * 3.14159265358979 / 180;

simulate::Scene office() {
  return test::shippedScene("small_office");
}

simulate::Scene walking(simulate::Scene scene, const std::vector<Eigen::Vector2d>& way, double turn_rad) {
  scene.path.start_heading_rad += turn_rad;
  scene.path.waypoints.clear();
  for (const Eigen::Vector2d& xy : way) scene.path.waypoints.push_back({xy, 0});
  return scene;
}

// The walk as a session's odometry tells it: ids from 0, odom where the body was at first.
std::vector<Keyframe> asSession(const LoopWalk& walk) {
  std::vector<Keyframe> out;
  const SE3 T_odom_building = walk.T_building_body.front().inverse();
  for (size_t i = 0; i < walk.keyframes.size(); ++i) {
    const SE3& T_building_body = walk.T_building_body[i];
    Keyframe k = walk.keyframes[i];
    k.T_odom_body = T_odom_building * T_building_body;
    k.up_body = T_building_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    k.up_sigma_rad = 0.01;
    if (i > 0) {
      RelativePose z;
      z.from = out.back().id;
      z.to = k.id;
      z.T_from_to = out.back().T_odom_body.inverse() * k.T_odom_body;
      z.covariance = 1e-6 * Matrix6d::Identity();
      k.relative_poses = {z};
    }
    out.push_back(std::move(k));
  }
  return out;
}

std::vector<MapView> asMap(const LoopWalk& walk, FloorId floor = FloorId{0}) {
  std::vector<MapView> out;
  for (size_t i = 0; i < walk.keyframes.size(); ++i)
    out.push_back({&walk.keyframes[i], walk.T_building_body[i], floor});
  return out;
}

std::optional<Relocalisation> find(const std::vector<MapView>& map, const std::vector<Keyframe>& session,
                                   const RelocaliseConfig& config = {}) {
  Relocaliser dut(config, {}, map);
  for (const Keyframe& keyframe : session)
    if (auto found = dut.step(keyframe)) return found;
  return std::nullopt;
}

TEST(RelocaliserTest, AStartInAnotherRoomWithAnotherHeadingIsFoundWithinTenMetres) {
  const LoopWalk first = test::walkThrough(office(), 3);
  const LoopWalk second = test::walkThrough(
      walking(office(), {{8.2, 6.4}, {8.2, 5.2}, {7.0, 5.8}, {5.0, 5.8}, {5.0, 2.2}, {7.2, 2.2}}, kTurn_rad),
      4);
  const auto found = find(asMap(first), asSession(second));
  ASSERT_TRUE(found);
  EXPECT_LE(found->walked_m, 10.0);
  const SE3 off = second.T_building_body.front().inverse() * found->T_map_odom;
  EXPECT_LT(off.translation.norm(), 0.05);
  EXPECT_LT(so3Log(off.rotation).norm(), 0.01);
  // The measurement of the first keyframe, and its covariance.
  EXPECT_EQ(found->first, KeyframeId{0});
  const SE3 T_true = first.T_building_body[static_cast<size_t>(found->anchor.value)].inverse() *
                     second.T_building_body.front();
  const Vector6d e = se3Log(T_true.inverse() * found->T_anchor_first);
  EXPECT_LT(e.dot(found->covariance.ldlt().solve(e)), 22.5);  // 99.9 % of chi2(6)
  EXPECT_LT(std::sqrt(found->covariance.topLeftCorner<3, 3>().trace()), 0.1);
  EXPECT_GE(found->looks, 3);
  // The same once more: to the last bit.
  const auto again = find(asMap(first), asSession(second));
  ASSERT_TRUE(again);
  EXPECT_EQ(again->T_anchor_first.translation, found->T_anchor_first.translation);
  EXPECT_EQ(again->covariance, found->covariance);
}

TEST(RelocaliserTest, AnotherBuildingIsNotFound) {
  const LoopWalk first = test::walkThrough(office(), 3);
  simulate::Scene other = simulate::makeBoxRoom(14, 9);
  other.boxes.push_back({"cupboard", {0.3, 4.2}, {0.6, 1.6}, 0, 1.9, 0});
  other.path.waypoints = {{{2, 2}, 0}, {{12, 2}, 0}, {{12, 7}, 0}, {{2, 7}, 0}};
  EXPECT_FALSE(find(asMap(first), asSession(test::walkThrough(other, 5))));
}

// Some metres of a corridor were once taken for those of another building, after forty that had looked
// otherwise.
TEST(RelocaliserTest, TheEndOfAWalkIsNoProofIfItsBeginningLookedOtherwise) {
  const LoopWalk first = test::walkThrough(office(), 3);
  std::vector<Keyframe> session = asSession(test::walkThrough(office(), 4));
  ASSERT_TRUE(find(asMap(first), session));
  simulate::Scene other = simulate::makeBoxRoom(14, 9);
  other.path.waypoints = {{{2, 2}, 0}, {{12, 2}, 0}, {{12, 7}, 0}, {{2, 7}, 0}};
  const LoopWalk elsewhere = test::walkThrough(other, 5);
  for (size_t i = 0; i + 14 < session.size(); ++i) {
    const Keyframe& seen = elsewhere.keyframes[i % elsewhere.keyframes.size()];
    session[i].points = seen.points;
    session[i].T_keyframe_body = seen.T_keyframe_body;
  }
  EXPECT_FALSE(find(asMap(first), session));
}

// Twenty offices that are one like the other: ten starts, each may stay lost and none may be wrong.
TEST(RelocaliserTest, InIdenticalOfficesNoStartIsWrong) {
  const simulate::Scene offices = test::shippedScene("offices20");
  const LoopWalk first = test::walkThrough(offices, 7, 90);
  for (int i = 0; i < 4; ++i) {
    const double x = 5.1 + 4.0 * i;
    const LoopWalk second = test::walkThrough(
        walking(offices, {{x, 1.5}, {x + 0.1, 3.4}, {x + 0.1, 6.0}, {x + 4.0, 6.0}}, kTurn_rad), 8);
    const auto found = find(asMap(first), asSession(second));
    if (!found) continue;
    const SE3 off = second.T_building_body.front().inverse() * found->T_map_odom;
    EXPECT_LT(off.translation.norm(), 0.1) << "start in office " << i;
  }
}

TEST(RelocaliserTest, StoreysThatAreAlikeAreNotTold) {
  const LoopWalk first = test::walkThrough(office(), 3);
  std::vector<MapView> map = asMap(first);
  LoopWalk above = first;
  for (size_t i = 0; i < above.keyframes.size(); ++i) {
    above.keyframes[i].id.value += 1000;
    above.T_building_body[i].translation.z() += 3.2;
  }
  for (const MapView& view : asMap(above, FloorId{1})) map.push_back(view);
  const LoopWalk second = test::walkThrough(
      walking(office(), {{8.2, 6.4}, {8.2, 5.2}, {7.0, 5.8}, {5.0, 5.8}, {5.0, 2.2}, {7.2, 2.2}}, kTurn_rad),
      4);
  EXPECT_FALSE(find(map, asSession(second)));
}

TEST(RelocaliserTest, ARobotThatWalksTooLongIsLost) {
  RelocaliseConfig config;
  config.give_up_m = 10;
  Relocaliser dut(config, {}, {});
  Keyframe keyframe;
  for (int i = 0; i < 12; ++i) {
    keyframe.id = KeyframeId{i};
    keyframe.T_odom_body.translation.x() = i;
    EXPECT_FALSE(dut.step(keyframe));
    EXPECT_EQ(dut.lost(), i > 10);
  }
  EXPECT_DOUBLE_EQ(dut.walked_m(), 11);
  EXPECT_FALSE(dut.describe().empty());
}

}  // namespace
}  // namespace sgraphs
