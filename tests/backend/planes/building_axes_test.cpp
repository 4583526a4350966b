#include "backend/planes/building_axes.h"

#include <gtest/gtest.h>

#include "tests/backend/planes/plane_world.h"

namespace sgraphs {
namespace {

using testing_support::Face;
using testing_support::planeOf;

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

Eigen::Vector3d heading(double angle_rad) {
  return {std::cos(angle_rad), std::sin(angle_rad), 0};
}

// Four walls of a room at this heading, slightly off by turns.
std::map<PlaneId, PlaneNode> room(double angle_rad, double noise_rad = 0) {
  std::map<PlaneId, PlaneNode> planes;
  for (int i = 0; i < 4; ++i) {
    const double off = (i % 2 == 0 ? 1 : -1) * noise_rad;
    planes[PlaneId{i}] =
        planeOf({3 * heading(angle_rad + i * M_PI / 2), -heading(angle_rad + i * M_PI / 2 + off)}, i);
  }
  return planes;
}

TEST(BuildingAxesTest, FollowTheWallsNotTheMap) {
  for (const double degrees : {-40.0, -20.0, 0.0, 10.0, 30.0, 44.0}) {
    BuildingAxes axes;
    axes.update(room(degrees * M_PI / 180), kUp);
    EXPECT_NEAR(axes.heading_rad(), degrees * M_PI / 180, 1e-9);
    EXPECT_EQ(axes.label(heading(degrees * M_PI / 180), kUp), PlaneLabel::kX);
    EXPECT_EQ(axes.label(-heading(degrees * M_PI / 180), kUp), PlaneLabel::kX);
    EXPECT_EQ(axes.label(heading((degrees + 90) * M_PI / 180), kUp), PlaneLabel::kY);
    EXPECT_EQ(axes.label(kUp, kUp), PlaneLabel::kHorizontal);
  }
}

// Mistake 6 of earlier systems: a robot started at 45 degrees whose classes flip between observations.
TEST(BuildingAxesTest, LabelsDoNotFlipAtFortyFiveDegrees) {
  BuildingAxes axes;
  axes.update(room(44.9 * M_PI / 180), kUp);
  const PlaneLabel label = axes.label(heading(M_PI / 4), kUp);
  for (const double degrees : {45.1, 44.8, 45.3, 44.9}) {
    axes.update(room(degrees * M_PI / 180, 0.003), kUp);
    EXPECT_EQ(axes.label(heading(M_PI / 4), kUp), label) << degrees;
  }
}

TEST(BuildingAxesTest, AWingAtTwentyEightDegreesDoesNotPullAtTheAxes) {
  auto planes = room(0);
  for (int i = 4; i < 6; ++i) {
    Face wing{{10, 0, 1}, -heading(28 * M_PI / 180)};
    planes[PlaneId{i}] = planeOf(wing, i);
  }
  BuildingAxes axes;
  axes.update(planes, kUp);
  EXPECT_NEAR(axes.heading_rad(), 0, 1e-9);
}

}  // namespace
}  // namespace sgraphs
