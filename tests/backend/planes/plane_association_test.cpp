#include "backend/planes/plane_association.h"

#include <gtest/gtest.h>

#include "backend/planes/plane_pairs.h"
#include "tests/backend/planes/plane_world.h"

namespace sgraphs {
namespace {

using testing_support::Face;
using testing_support::observe;
using testing_support::planeOf;

Matrix6d poseCovariance(double sigma_m, double sigma_rad) {
  Vector6d v;
  v << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return v.asDiagonal();
}

class PlaneAssociationTest : public ::testing::Test {
 protected:
  std::vector<std::optional<size_t>> associate(const std::vector<Face>& seen, const SE3& T,
                                               double drift_m = 0.01, double drift_rad = 0.002) {
    std::vector<PlaneObservation> observations;
    observations.reserve(seen.size());
    for (const Face& face : seen) observations.push_back(observe(face, T_true));
    std::vector<PlaneCandidate> candidates;
    for (const PlaneNode& plane : planes)
      candidates.push_back(
          {&plane, testing_support::observationCovariance(), poseCovariance(drift_m, drift_rad)});
    return associatePlanes(observations, T, candidates, gate);
  }

  AssociationGate gate;
  SE3 T_true{so3Exp({0.01, -0.02, 0.6}), {1.0, 0.5, 0.6}};
  const Face wall{{5, 0, 1.2}, {-1, 0, 0}};
  std::vector<PlaneNode> planes;
};

TEST_F(PlaneAssociationTest, AWallSeenAgainIsFound) {
  planes = {planeOf(wall)};
  const SE3 guess = T_true * se3Exp((Vector6d() << 0.01, -0.01, 0.005, 0.001, 0.001, -0.002).finished());
  EXPECT_EQ(associate({wall}, guess)[0], 0u);
}

TEST_F(PlaneAssociationTest, TheOtherSideOfAThinWallIsAnotherPlane) {
  planes = {planeOf(wall)};
  const Face behind{{5.05, 0, 1.2}, {1, 0, 0}};
  EXPECT_FALSE(associate({behind}, T_true)[0]);
}

TEST_F(PlaneAssociationTest, ParallelWallsThirtyCentimetresApartAreToldApart) {
  const Face second{{5.3, 0, 1.2}, {-1, 0, 0}};
  planes = {planeOf(wall, 0), planeOf(second, 1)};
  const auto found = associate({second, wall}, T_true);
  EXPECT_EQ(found[0], 1u);
  EXPECT_EQ(found[1], 0u);
}

TEST_F(PlaneAssociationTest, WithDriftAsLargeAsTheirDistanceNeitherIsTaken) {
  const Face second{{5.3, 0, 1.2}, {-1, 0, 0}};
  planes = {planeOf(wall, 0), planeOf(second, 1)};
  SE3 half = T_true;
  half.translation.x() += 0.15;
  EXPECT_FALSE(associate({wall}, half, 0.3, 0.002)[0]);
}

TEST_F(PlaneAssociationTest, FarAlongTheSamePlaneIsAnotherWall) {
  planes = {planeOf(wall)};
  const Face next_room{{5, 8, 1.2}, {-1, 0, 0}};
  EXPECT_FALSE(associate({next_room}, T_true)[0]);
  const Face beyond_a_door{{5, 5, 1.2}, {-1, 0, 0}};
  EXPECT_EQ(associate({beyond_a_door}, T_true)[0], 0u);
}

TEST_F(PlaneAssociationTest, PiecesOfOneFaceShareItAndOverlappingOnesDoNot) {
  Face whole = wall;
  whole.half_width_m = 4;
  planes = {planeOf(whole)};
  Face left = wall, right = wall;
  left.centre.y() = 2.5;
  right.centre.y() = -2.5;
  const auto pieces = associate({left, right}, T_true);
  EXPECT_EQ(pieces[0], 0u);
  EXPECT_EQ(pieces[1], 0u);
  const auto doubled = associate({left, left}, T_true);
  EXPECT_NE(doubled[0].has_value(), doubled[1].has_value());
}

TEST_F(PlaneAssociationTest, SurfacesAreOneOrTwo) {
  Face beside = wall;
  beside.centre.y() = 3;
  EXPECT_TRUE(areOneSurface(planeOf(wall, 0), planeOf(beside, 1), gate));
  beside.centre.x() = 5.1;
  EXPECT_FALSE(areOneSurface(planeOf(wall, 0), planeOf(beside, 1), gate));
  beside = wall;
  beside.centre.y() = 5;
  EXPECT_FALSE(areOneSurface(planeOf(wall, 0), planeOf(beside, 1), gate)) << "extents do not meet";
}

// In a stairwell one wall was mapped from a storey and from the stairs, and stayed two for good.
TEST_F(PlaneAssociationTest, WhatWasSeenFromTheStairsMayBeAStoreysWall) {
  PlaneNode below = planeOf(wall, 0), other = planeOf(wall, 1);
  other.floor = FloorId{1};
  EXPECT_FALSE(areOneSurface(below, other, gate));
  other.floor = {};
  EXPECT_TRUE(areOneSurface(below, other, gate));
  EXPECT_TRUE(areOneSurface(other, below, gate));
}

TEST_F(PlaneAssociationTest, FacesOfOneWallFaceAwayFromEachOther) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Face back{{5.05, 0.3, 1.2}, {1, 0, 0}};
  EXPECT_TRUE(areFacesOfOneWall(planeOf(wall, 0), planeOf(back, 1), up));
  EXPECT_TRUE(areFacesOfOneWall(planeOf(back, 1), planeOf(wall, 0), up));
  const Face across_a_passage{{4.5, 0, 1.2}, {1, 0, 0}};
  EXPECT_FALSE(areFacesOfOneWall(planeOf(wall, 0), planeOf(across_a_passage, 1), up));
  const Face elsewhere{{5.05, 6, 1.2}, {1, 0, 0}};
  EXPECT_FALSE(areFacesOfOneWall(planeOf(wall, 0), planeOf(elsewhere, 1), up));
}

TEST_F(PlaneAssociationTest, FloorsShareAHeightWithinFiveCentimetres) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Face floor{{0, 0, 0}, {0, 0, 1}, 3, 3};
  Face next{{9, 0, 0.02}, {0, 0, 1}, 3, 3};
  EXPECT_TRUE(areOneHeight(planeOf(floor, 0), planeOf(next, 1), up));
  next.centre.z() = 0.2;
  EXPECT_FALSE(areOneHeight(planeOf(floor, 0), planeOf(next, 1), up));
  const Face ceiling{{0, 0, 0.0}, {0, 0, -1}, 3, 3};
  EXPECT_FALSE(areOneHeight(planeOf(floor, 0), planeOf(ceiling, 1), up));
}

}  // namespace
}  // namespace sgraphs
