#include "tools/simulate/building/people.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tools/simulate/sensor/random_stream.h"

namespace sgraphs::simulate {
namespace {

Person walker() {
  Person person;
  person.waypoints = {{0, 0}, {3, 0}, {3, 4}};
  person.speed_mps = 1.0;
  person.start_s = 2.0;
  return person;
}

Eigen::Vector2d placeAt(const People& people, double seconds) {
  return people.at(seconds).bodies().front().center;
}

TEST(PeopleTest, WalkToAndFroAlongTheirLine) {
  const People people({walker()}, {0.0});
  const auto expect = [&](double seconds, double x, double y) {
    EXPECT_LT((placeAt(people, seconds) - Eigen::Vector2d(x, y)).norm(), 1e-9) << seconds;
  };
  expect(0, 0, 0);
  expect(2, 0, 0);
  expect(3.5, 1.5, 0);
  expect(5, 3, 0);
  expect(7, 3, 2);
  expect(9, 3, 4);
  expect(10, 3, 3);  // on the way back
  expect(14, 2, 0);
  expect(16, 0, 0);
  expect(17, 1, 0);  // and off again
}

TEST(PeopleTest, StandWithOneWaypointAndOnTheirFloor) {
  Person person;
  person.waypoints = {{1, 2}};
  person.floor = 1;
  const People people({person}, {0.0, 3.0});
  EXPECT_EQ(placeAt(people, 0), placeAt(people, 100));
  const auto hit = people.at(5).cast({1, 2, 10}, {0, 0, -1}, 100);
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->range_m, 10 - 3 - person.height_m, 1e-9);
}

TEST(PeopleTest, RayMeetsTheTrunkWhereItIsAtThatInstant) {
  const Person person = walker();
  const People people({person}, {0.0});
  const double chest = 1.2;
  const auto range = [&](double seconds, const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
    const auto hit = people.at(seconds).cast(from, way, 100);
    return hit ? hit->range_m : -1.0;
  };
  EXPECT_NEAR(range(3.5, {1.5, -4, chest}, {0, 1, 0}), 4 - person.radius_m, 1e-9);
  EXPECT_EQ(range(2.0, {1.5, -4, chest}, {0, 1, 0}), -1);
  EXPECT_EQ(range(3.5, {1.5, -4, chest}, {0, -1, 0}), -1);  // behind the ray
  EXPECT_NEAR(range(3.5, {1.6, -4, chest}, {0, 1, 0}), 4 - std::sqrt(std::pow(person.radius_m, 2) - 0.01),
              1e-9);
  EXPECT_EQ(range(3.5, {1.5, -4, person.height_m + 0.01}, {0, 1, 0}), -1);
  EXPECT_FALSE(people.at(3.5).cast({1.5, -4, chest}, {0, 1, 0}, 3.7).has_value());
  EXPECT_EQ(range(3.5, {1.5, 0, chest}, {0, 1, 0}), -1);  // a sensor within somebody sees nothing of him
}

TEST(PeopleTest, LegsSwingWithTheDistanceWalked) {
  const People people({walker()}, {0.0});
  const auto legs = [&](double seconds) {
    const auto parts = people.at(seconds).bodies().front().parts;
    return parts[0].center.x() - parts[1].center.x();
  };
  EXPECT_NEAR(legs(1.0), 0, 1e-12);    // stands before the start
  EXPECT_NEAR(legs(2.35), 0.4, 1e-9);  // a quarter of the stride of 1.4 m: fully apart
  EXPECT_NEAR(legs(2.7), 0, 1e-9);
  EXPECT_NEAR(legs(3.05), -0.4, 1e-9);
}

TEST(PeopleTest, BodiesReachNoFartherThanTheyClaim) {
  const People people({walker()}, {0.0});
  for (double t = 0; t < 20; t += 0.13) {
    const PeopleNow now = people.at(t);
    for (const auto& body : now.bodies())
      for (const UprightCylinder& part : body.parts)
        EXPECT_LE((part.center - body.center).norm() + part.radius_m, body.reach_m + 1e-12);
  }
}

// A hit lies on the surface, and no point before it lies within.
TEST(UprightCylinderTest, RaysFromAnywhereEnterAtTheSurface) {
  const UprightCylinder cylinder{{0.3, -0.2}, 0.5, 1.0, 2.5};
  const auto depth = [&](const Eigen::Vector3d& p) {  // positive inside
    return std::min({cylinder.radius_m - (p.head<2>() - cylinder.center).norm(), p.z() - cylinder.z_min_m,
                     cylinder.z_max_m - p.z()});
  };
  RandomStream random(5, 0);
  int hits = 0, misses = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d from(3 * random.normal(), 3 * random.normal(), 3 * random.normal());
    if (depth(from) > 0) continue;
    const Eigen::Vector3d aim(random.normal(), random.normal(), 1.7 + random.normal());
    const Eigen::Vector3d way = (aim - from).normalized();
    const auto hit = intersect(cylinder, from, way, 30);
    const double end = hit ? hit->range_m : 20.0;
    for (double t = 0; t < end - 1e-6; t += 0.01) ASSERT_LE(depth(from + t * way), 1e-9) << i;
    if (hit) {
      EXPECT_NEAR(depth(from + hit->range_m * way), 0, 1e-9);
      EXPECT_GE(hit->cos_incidence, 0);
      EXPECT_LE(hit->cos_incidence, 1);
    }
    ++(hit ? hits : misses);
  }
  EXPECT_GT(hits, 300);
  EXPECT_GT(misses, 300);
}

}  // namespace
}  // namespace sgraphs::simulate
