#include "perception/odometry/surfel_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace sgraphs {
namespace {

constexpr double kMerge_m = 0.08;
constexpr double kGate_m = 0.3;
constexpr double kMinCos = 0.94;

// A patch of 20 returns, 10 cm wide and 15 mm thick.
Surfel patch(const Eigen::Vector3d& mean, const Eigen::Vector3d& normal) {
  Surfel s;
  s.mean = mean;
  s.normal = normal.normalized();
  s.covariance = 0.01 / 3 * (Eigen::Matrix3d::Identity() - s.normal * s.normal.transpose()) +
                 0.015 * 0.015 * s.normal * s.normal.transpose();
  s.count = 20;
  s.variance_m2 = 0.015 * 0.015 / 20;
  return s;
}

// Patches of an upright wall through `on`, `length` m to either side and 2 m high, with noise along the
// normal and of the normal's direction.
std::vector<Surfel> wall(const Eigen::Vector3d& on, const Eigen::Vector3d& normal, int count, uint32_t seed,
                         double noise_m = 0.004, double noise_rad = 0.05) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal_distribution;
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::Vector3d along = Eigen::Vector3d::UnitZ().cross(normal.normalized());
  std::vector<Surfel> patches;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d at = on + 2.0 * uniform(random) * along +
                               uniform(random) * Eigen::Vector3d::UnitZ() +
                               noise_m * normal_distribution(random) * normal.normalized();
    const double turn = noise_rad * normal_distribution(random);
    patches.push_back(patch(at, so3Exp({0, 0, turn}) * normal));
  }
  return patches;
}

SurfelMap mapInBody(const std::vector<Surfel>& patches) {
  SurfelMap map(0.5);
  for (const Surfel& s : patches) map.insert(s, SE3(), kMerge_m);
  return map;
}

TEST(SurfelMapTest, ThinWallSeenFromBothSidesGivesTwoFacesWithoutBias) {
  const Eigen::Vector3d n = Eigen::Vector3d::UnitX();
  std::vector<Surfel> patches = wall({2.20, 0, 0}, -n, 4000, 1);
  for (const Surfel& s : wall({2.25, 0, 0}, n, 4000, 2)) patches.push_back(s);
  const SurfelMap map = mapInBody(patches);
  for (double y = -1.5; y <= 1.5; y += 0.25) {
    const MapCell* front = map.match({2.20, y, 0.1}, -n, kGate_m, kMinCos);
    const MapCell* back = map.match({2.25, y, 0.1}, n, kGate_m, kMinCos);
    ASSERT_TRUE(front && back);
    EXPECT_NE(front, back);
    EXPECT_NEAR(front->mean.x(), 2.20, 0.002);
    EXPECT_NEAR(back->mean.x(), 2.25, 0.002);
    EXPECT_LT(front->normal.x(), -0.999);
    EXPECT_GT(back->normal.x(), 0.999);
  }
}

TEST(SurfelMapTest, PlaneOnTheBorderOfCubesIsNotCutInHalves) {
  // The noise puts patches into the cubes on either side of x = 2.
  const SurfelMap map = mapInBody(wall({2.0, 0, 0}, -Eigen::Vector3d::UnitX(), 3000, 3));
  // 4 m by 2 m in cells of half a metre, begun at random places: 8 x 4 whole ones and no second layer.
  EXPECT_EQ(map.size(), 32u);
  for (const MapCell& cell : map.cells()) EXPECT_NEAR(cell.mean.x(), 2.0, 0.002);
}

TEST(SurfelMapTest, WallAt45DegreesIsNotSplitByItsTwoFacings) {
  const Eigen::Vector3d n(-1, -1, 0);
  const std::vector<Surfel> patches = wall({1.25, 1.25, 0}, n, 3000, 4);
  const SurfelMap map = mapInBody(patches);
  double total = 0, one_noise = 0;
  for (const MapCell& cell : map.cells()) {
    total += cell.count;
    // Cells of its own half-planes would lie on one side of the wall.
    if (cell.count > 200)
      one_noise = std::max(one_noise, std::abs((cell.mean - patches[0].mean).dot(n.normalized())));
  }
  EXPECT_GT(total, 0.97 * 20 * 3000);
  EXPECT_LT(one_noise, 0.015);
  int matched = 0;
  for (const Surfel& s : wall({1.25, 1.25, 0}, n, 500, 5)) {
    const MapCell* cell = map.match(s.mean, s.normal, kGate_m, kMinCos);
    if (!cell) continue;
    ++matched;
    EXPECT_LT(std::abs(cell->normal.dot(s.mean - cell->mean)), 0.02);
  }
  EXPECT_GT(matched, 490);
}

TEST(SurfelMapTest, CellHoldsTheMomentsOfItsPoints) {
  std::vector<Surfel> patches;
  for (const double y : {0.10, 0.20, 0.35}) patches.push_back(patch({0.2, y, 0.25}, {1, 0, 0}));
  const SurfelMap map = mapInBody(patches);
  ASSERT_EQ(map.size(), 1u);
  const MapCell& cell = map.cells()[0];
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Surfel& s : patches) mean += s.mean / 3;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Surfel& s : patches)
    scatter += s.count * (s.covariance + (s.mean - mean) * (s.mean - mean).transpose());
  EXPECT_LT((cell.mean - mean).norm(), 1e-12);
  EXPECT_LT((cell.scatter - scatter).norm(), 1e-12);
  EXPECT_EQ(cell.count, 60);
}

TEST(SurfelMapTest, OrderOfPatchesOfOneSurfaceChangesOnlyRounding) {
  std::vector<Surfel> patches = wall({2.2, 0.1, 0.1}, {-1, 0, 0}, 1000, 6, 0.004, 0.0);
  const SurfelMap forward = mapInBody(patches);
  std::reverse(patches.begin(), patches.end());
  const SurfelMap backward = mapInBody(patches);
  ASSERT_EQ(forward.size(), backward.size());
  for (const MapCell& cell : forward.cells()) {
    const MapCell* other = backward.match(cell.mean, cell.normal, kGate_m, kMinCos);
    ASSERT_TRUE(other);
    EXPECT_EQ(other->count, cell.count);
    EXPECT_LT((other->mean - cell.mean).norm(), 1e-9);
    EXPECT_LT((other->normal - cell.normal).norm(), 1e-6);
  }
}

TEST(SurfelMapTest, PruneForgetsWhatIsFarAndFindsTheRest) {
  std::vector<Surfel> patches;
  for (double x = 0.25; x < 100; x += 0.5) patches.push_back(patch({x, 0.25, 0.25}, {0, 1, 0}));
  SurfelMap map = mapInBody(patches);
  ASSERT_EQ(map.size(), patches.size());
  map.prune({50, 0, 0}, 10);
  EXPECT_EQ(map.size(), 40u);
  for (const Surfel& s : patches) {
    const MapCell* cell = map.match(s.mean, s.normal, kGate_m, kMinCos);
    ASSERT_EQ(cell != nullptr, (s.mean - Eigen::Vector3d(50, 0, 0)).norm() < 10);
    if (cell) {
      EXPECT_LT((cell->mean - s.mean).norm(), 1e-12);
    }
  }
  // A surface that was forgotten may come back.
  map.insert(patches[0], SE3(), kMerge_m);
  EXPECT_TRUE(map.match(patches[0].mean, patches[0].normal, kGate_m, kMinCos));
}

TEST(SurfelMapTest, MatchKeepsItsGates) {
  const Eigen::Vector3d n(0, 0, 1);
  const SurfelMap map = mapInBody({patch({0.25, 0.25, 0.1}, n)});
  EXPECT_TRUE(map.match({0.3, 0.3, 0.39}, n, 0.3, kMinCos));
  EXPECT_FALSE(map.match({0.3, 0.3, 0.41}, n, 0.3, kMinCos)) << "beyond the gate";
  EXPECT_TRUE(map.match({0.3, 0.3, 0.1}, so3Exp({0.3, 0, 0}) * n, 0.3, std::cos(0.35)));
  EXPECT_FALSE(map.match({0.3, 0.3, 0.1}, so3Exp({0.4, 0, 0}) * n, 0.3, std::cos(0.35))) << "turned away";
  EXPECT_FALSE(map.match({0.3, 0.3, 0.1}, -n, 0.3, kMinCos)) << "seen from behind";
  EXPECT_FALSE(map.match({1.3, 0.3, 0.1}, n, 0.3, kMinCos)) << "another cube";
  Surfel young = patch({5.25, 0.25, 0.1}, n);
  young.count = 8;
  EXPECT_FALSE(mapInBody({young}).match(young.mean, n, 0.3, kMinCos)) << "too few points to know its plane";
}

TEST(SurfelMapTest, MovesPatchesIntoTheMapsFrame) {
  const SE3 T_map_body(so3Exp({0.2, -0.1, 1.3}), {10, -4, 2});
  const Surfel s = patch({1.2, 0.3, -0.4}, {0.3, -0.9, 0.2});
  SurfelMap map(0.5);
  map.insert(s, T_map_body, kMerge_m);
  ASSERT_EQ(map.size(), 1u);
  EXPECT_LT((map.cells()[0].mean - T_map_body * s.mean).norm(), 1e-12);
  EXPECT_LT((map.cells()[0].normal - T_map_body.rotation * s.normal).norm(), 1e-6);
}

TEST(SurfelMapTest, RobotThatStandsForHoursDoesNotWeighTheMapDown) {
  SurfelMap map(0.5);
  const Surfel s = patch({0.25, 0.25, 0.25}, {0, 0, 1});
  for (int i = 0; i < 100000; ++i) map.insert(s, SE3(), kMerge_m);
  EXPECT_LT(map.cells()[0].count, 30000);
}

}  // namespace
}  // namespace sgraphs
