#include "perception/free_space/keyframe_rays.h"

#include <gtest/gtest.h>

#include "tests/perception/free_space/box_world.h"

namespace sgraphs {
namespace {

Keyframe keyframeOf(const std::vector<Eigen::Vector3f>& points) {
  Keyframe keyframe;
  keyframe.T_body_lidar.translation = {0, 0, 0.3};
  keyframe.T_keyframe_body = {SE3{}};
  for (const Eigen::Vector3f& p : points) keyframe.points.push_back({.position_body = p});
  return keyframe;
}

TEST(RayThinnerTest, OneRayPerPlace) {
  RayThinner thinner(0.1, 12.0);
  const Keyframe keyframe =
      keyframeOf({{3.01f, 0, 0.3f}, {3.08f, 0.01f, 0.31f}, {3.01f, 0, 0.7f}, {3.11f, 0, 0.3f}});
  const KeyframeRays rays = thinner.thin(keyframe, std::nullopt);
  ASSERT_EQ(rays.rays.size(), 3u);
  EXPECT_EQ(rays.rays[0].end_cm, (std::array<int16_t, 3>{301, 0, 30}));
  EXPECT_EQ(thinner.thin(keyframe, std::nullopt).rays.size(), 3u) << "nothing is left of the last keyframe";
}

TEST(RayThinnerTest, FarRaysEndInTheMiddleOfNothing) {
  const KeyframeRays rays =
      RayThinner(0.1, 12.0).thin(keyframeOf({{30.0f, 0, 0.3f}, {5.0f, 0, 0.3f}}), std::nullopt);
  ASSERT_EQ(rays.rays.size(), 2u);
  EXPECT_FALSE(rays.rays[0].is_hit);
  EXPECT_EQ(rays.rays[0].end_cm[0], 1200);
  EXPECT_TRUE(rays.rays[1].is_hit);
}

TEST(RayThinnerTest, ViewpointsApartSeeForThemselves) {
  Keyframe keyframe = keyframeOf({{3, 0, 0.3f}, {3, 0, 0.3f}, {3, 0, 0.3f}});
  keyframe.T_keyframe_body = {SE3{}, SE3{Eigen::Quaterniond::Identity(), {0.1, 0, 0}},
                              SE3{Eigen::Quaterniond::Identity(), {1.0, 0, 0}}};
  for (uint8_t i = 0; i < 3; ++i) keyframe.points[i].scan = i;
  const KeyframeRays rays = RayThinner(0.1, 12.0).thin(keyframe, std::nullopt);
  ASSERT_EQ(rays.rays.size(), 2u);
  EXPECT_EQ(rays.rays[1].viewpoint, 2);
}

TEST(RayThinnerTest, FloorIsThinnedMoreThanWalls) {
  BoxWorld world;
  world.addRoom({-5, -4}, {5, 4});
  const Keyframe keyframe = world.keyframe(0, bodyAt(0, 0));
  RayThinner thinner(0.1, 12.0);
  const auto all = thinner.thin(keyframe, std::nullopt),
             fewer = thinner.thin(keyframe, BoxWorld::kBodyHeight_m);
  auto walls = [](const KeyframeRays& rays) {
    return std::count_if(rays.rays.begin(), rays.rays.end(), [](const KeyframeRays::Ray& ray) {
      return ray.end_cm[2] > -40 && ray.end_cm[2] < 140;
    });
  };
  EXPECT_LT(fewer.rays.size(), all.rays.size());
  EXPECT_EQ(walls(fewer), walls(all));
}

}  // namespace
}  // namespace sgraphs
