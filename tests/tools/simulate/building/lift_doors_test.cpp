#include "tools/simulate/building/lift_doors.h"

#include <gtest/gtest.h>

namespace sgraphs::simulate {
namespace {

// Two floors; a door along y at x = 2. Up at 10 s, and down again at 40 s.
Scene shaft() {
  Scene scene;
  scene.floors_z_m = {0.0, 3.0};
  scene.lifts.push_back({"A", {0, 1}, {2, 1}, {2, 2}, 2.1});
  return scene;
}

const std::vector<Ride> kRides{{0, 0, 3, 10, 12, 17, 19}, {0, 3, 0, 40, 42, 47, 49}};

// How far is seen along x towards the middle of the right leaf, 1.2 m above the floor; 9: past the door.
double seen(const LiftDoors& doors, double seconds, double floor_z_m) {
  const auto hit = doors.at(seconds).cast({0, 1.75, floor_z_m + 1.2}, {1, 0, 0}, 9);
  return hit ? hit->range_m : 9;
}

TEST(LiftDoorsTest, TheCarIsWhereTheRidesTakeIt) {
  const LiftDoors doors(shaft(), kRides, 0);
  EXPECT_EQ(seen(doors, 0, 0), 9) << "it waits where the first ride begins";
  EXPECT_EQ(seen(doors, 0, 3), 2);
  for (const double riding : {12.0, 14.0, 17.0}) {
    EXPECT_EQ(seen(doors, riding, 0), 2) << riding;
    EXPECT_EQ(seen(doors, riding, 3), 2) << riding;
  }
  EXPECT_EQ(seen(doors, 30, 0), 2);
  EXPECT_EQ(seen(doors, 30, 3), 9);
  EXPECT_EQ(seen(doors, 60, 0), 9) << "and stays where the last one ended";
  EXPECT_EQ(seen(doors, 60, 3), 2);
}

TEST(LiftDoorsTest, LeavesMeetHalfWay) {
  const LiftDoors doors(shaft(), kRides, 0);
  const auto halfway = doors.at(11).leaves();  // and two of the floor above
  ASSERT_EQ(halfway.size(), 4u);
  EXPECT_NEAR(halfway[0].b.y(), 1.25, 1e-12);
  EXPECT_NEAR(halfway[1].b.y(), 1.75, 1e-12);
  EXPECT_EQ(doors.at(14).leaves()[0].b, doors.at(14).leaves()[1].b);
}

TEST(LiftDoorsTest, AnEmptyCarIsCalledBetweenRides) {
  const std::vector<Ride> up_twice{kRides[0], {0, 0, 3, 60, 62, 67, 69}};
  const LiftDoors doors(shaft(), up_twice, 0);
  EXPECT_EQ(seen(doors, 25, 3), 9);
  EXPECT_EQ(seen(doors, 55, 3), 2);
  EXPECT_EQ(seen(doors, 55, 0), 9);
}

TEST(LiftDoorsTest, RaysMeetLeavesOnlyWhereTheyAre) {
  const LiftDoorsNow closed = LiftDoors(shaft(), kRides, 0).at(14);
  EXPECT_FALSE(closed.cast({0, 1.5, 2.2}, {1, 0, 0}, 9)) << "above the door";
  EXPECT_FALSE(closed.cast({0, 0.9, 1}, {1, 0, 0}, 9)) << "beside it";
  EXPECT_FALSE(closed.cast({3, 1.5, 1}, {1, 0, 0}, 9)) << "behind";
  EXPECT_FALSE(closed.cast({0, 1.5, 1}, {1, 0, 0}, 1.5)) << "beyond reach";
  EXPECT_FALSE(closed.cast({0, 1.5, 1}, {0, 1, 0}, 9)) << "along it";
  const Eigen::Vector3d askew = Eigen::Vector3d(1, 0.2, 0).normalized();
  const auto hit = closed.cast({0, 1.2, 1}, askew, 9);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->range_m, 2 / askew.x(), 1e-12);
  EXPECT_NEAR(hit->cos_incidence, askew.x(), 1e-12);
}

TEST(LiftDoorsTest, TheTruthHoldsEveryDoorOnce) {
  EXPECT_EQ(LiftDoors(shaft(), kRides, 0).closed().triangles.size(), 4u);
  EXPECT_TRUE(LiftDoors(Scene(), {}, 0).empty());
}

}  // namespace
}  // namespace sgraphs::simulate
