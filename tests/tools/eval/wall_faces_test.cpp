#include "tools/eval/wall_faces.h"

#include <gtest/gtest.h>

#include "tests/tools/eval/two_rooms.h"

namespace sgraphs {
namespace {

using test::TwoRooms;

struct Look {
  TwoRooms rooms;
  MeshQuery mesh{rooms.mesh};
  std::vector<TrueFace> faces = trueFaces(rooms.plan, mesh);

  void from(const std::vector<StampedPose>& poses) {
    lookFromPath(poses, rooms.plan.T_body_lidar, mesh, faces);
  }
};

double exposedArea(const TrueFace& face) {
  double area = 0;
  for (const FaceSample& sample : face.samples) area += sample.exposed ? face.sample_area_m2 : 0;
  return area;
}

TEST(WallFacesTest, EachWallHasTwoFacesThatLookAwayFromEachOther) {
  const Look look;
  ASSERT_EQ(look.faces.size(), 10u);
  for (size_t i = 0; i < 10; i += 2) {
    const TrueFace &left = look.faces[i], &right = look.faces[i + 1];
    EXPECT_NEAR((left.normal() + right.normal()).norm(), 0, 1e-12);
    EXPECT_NEAR(left.distance(right.point({1, 1})), -0.1, 1e-12);
    EXPECT_NEAR(left.length(), right.length(), 1e-12);
  }
  EXPECT_NEAR((look.faces[TwoRooms::kSouth].normal() - Eigen::Vector3d::UnitY()).norm(), 0, 1e-12);
  EXPECT_NEAR(look.faces[TwoRooms::kSouth].distance({3, 1.05, 1}), 1, 1e-12);
}

TEST(WallFacesTest, ADoorwayIsNoSurface) {
  const Look look;
  // To a column of samples: two lie on the doorway's edges.
  EXPECT_NEAR(exposedArea(look.faces[TwoRooms::kPartitionWest]), 3 * 2.5, 0.55);
  EXPECT_NEAR(exposedArea(look.faces[TwoRooms::kSouth]), 8 * 2.5, 0.3);
}

TEST(WallFacesTest, OnlyWhatTheSensorSeesIsSeen) {
  Look look;
  look.from(TwoRooms::standing(10));
  for (const size_t f : {TwoRooms::kSouth, TwoRooms::kNorth, TwoRooms::kWest, TwoRooms::kPartitionWest})
    EXPECT_NEAR(look.faces[f].seen_s, 10, 0.6) << f;
  for (const size_t f : {TwoRooms::kSouth + 1, TwoRooms::kEast + 1, TwoRooms::kNorth + 1, TwoRooms::kWest + 1,
                         TwoRooms::kPartitionEast})
    EXPECT_EQ(look.faces[f].seen_s, 0) << f;
}

TEST(WallFacesTest, TheFarRoomsWallIsHiddenByThePartition) {
  Look look;
  // Level with the middle of the partition's southern half: the doorway's view ends on the northern wall.
  look.from(TwoRooms::standing(10, {3.8, 0.4, 0.5}));
  double hidden = 0;
  for (const FaceSample& sample : look.faces[TwoRooms::kEast].samples) hidden += sample.seen_s;
  EXPECT_EQ(hidden, 0);
}

TEST(WallFacesTest, WhatIsAboveTheLasersIsNotSeen) {
  Look look;
  look.from(TwoRooms::standing(2));
  // The sensor is 1 m high and 0.75 m from the southern wall's face: 15 deg reach 0.2 m up and down.
  for (const FaceSample& sample : look.faces[TwoRooms::kSouth].samples)
    if (std::abs(sample.at.x() - 2) < 0.3 && std::abs(sample.at.y() - 1) > 0.25) {
      EXPECT_EQ(sample.seen_s, 0) << sample.at.transpose();
    }
}

TEST(WallFacesTest, FurnitureHidesTheWallBehind) {
  Look look;
  look.from(TwoRooms::standing(10, {1.2, 3.4, 0.5}));
  int hidden = 0;
  for (const FaceSample& sample : look.faces[TwoRooms::kWest].samples) {
    const Eigen::Vector3d p = look.faces[TwoRooms::kWest].point(sample.at);
    if (p.y() < 3.1 || p.y() > 3.7 || p.z() > 1.2) continue;
    EXPECT_EQ(sample.seen_s, 0) << p.transpose();
    ++hidden;
  }
  EXPECT_GT(hidden, 10);
}

}  // namespace
}  // namespace sgraphs
