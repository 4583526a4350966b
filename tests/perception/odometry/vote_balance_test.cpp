#include "perception/odometry/vote_balance.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace sgraphs {
namespace {

MapCell cellAt(double x, double y, const Eigen::Vector3d& normal) {
  MapCell cell;
  cell.mean = {x, y, 1.0};
  cell.normal = normal;
  return cell;
}

// A corridor along x: walls on both sides, `ends` cells that look along it, one metre apart, and somebody.
struct Corridor {
  std::vector<MapCell> cells;
  std::vector<PatchVote> votes;
  std::vector<size_t> walls, ends, person;

  Corridor(int num_ends, int person_patches) {
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
    for (int i = 0; i < 40; ++i) cells.push_back(cellAt(0.5 * i, 1.0, -y));
    for (int i = 0; i < num_ends; ++i) cells.push_back(cellAt(1.0 * i, i % 2 == 0 ? 0.9 : -0.9, -x));
    for (int i = 0; i < 3; ++i) cells.push_back(cellAt(5.3, 0.1 * i, -x));
    size_t next = 0;
    for (int i = 0; i < 40; ++i) add(next++, 10, walls);
    for (int i = 0; i < num_ends; ++i) add(next++, 2, ends);
    for (int i = 0; i < 3; ++i) add(next++, person_patches, person);
  }

  void add(size_t cell, int patches, std::vector<size_t>& group) {
    for (int i = 0; i < patches; ++i) {
      group.push_back(votes.size());
      votes.push_back({&cells[cell], 1e4});
    }
  }

  double along(const std::vector<double>& factors, const std::vector<size_t>& group) const {
    double sum = 0;
    for (const size_t i : group) sum += factors[i] * votes[i].weight;
    return sum;
  }
};

TEST(VoteBalanceTest, SomebodyCloseByIsCutToAShareOfTheRest) {
  const Corridor corridor(20, 150);
  const std::vector<double> factors = balanceVotes(corridor.votes, 0.0);
  const double person = corridor.along(factors, corridor.person),
               rest = corridor.along(factors, corridor.ends);
  EXPECT_LT(person, 0.31 * rest);
  EXPECT_GT(person, 0.2 * rest);
  for (const size_t i : corridor.walls) EXPECT_EQ(factors[i], 1.0);
}

TEST(VoteBalanceTest, WhereManyThingsSpeakNothingIsCut) {
  const Corridor corridor(20, 3);
  for (const double factor : balanceVotes(corridor.votes, 0.0)) EXPECT_EQ(factor, 1.0);
}

TEST(VoteBalanceTest, TheOnlyThingThatSpeaksIsHeard) {
  const Corridor corridor(0, 150);
  for (const double factor : balanceVotes(corridor.votes, 0.0)) EXPECT_EQ(factor, 1.0);
}

TEST(VoteBalanceTest, TheOrderOfTheVotesDoesNotMatter) {
  Corridor corridor(20, 150);
  const std::vector<double> before = balanceVotes(corridor.votes, 0.0);
  std::reverse(corridor.votes.begin(), corridor.votes.end());
  std::vector<double> after = balanceVotes(corridor.votes, 0.0);
  std::reverse(after.begin(), after.end());
  ASSERT_EQ(after.size(), before.size());
  for (size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(after[i], before[i], 1e-12);
}

TEST(VoteBalanceTest, PatchesThatMeetNothingAreLeftAlone) {
  Corridor corridor(20, 150);
  corridor.votes.push_back({});
  EXPECT_EQ(balanceVotes(corridor.votes, 0.0).back(), 1.0);
  EXPECT_TRUE(balanceVotes({}, 0.0).empty());
  EXPECT_EQ(balanceVotes({PatchVote{}}, 0.003), std::vector<double>{1.0});
}

TEST(VoteBalanceTest, WhatIsWrongWithACellDoesNotAverageOut) {
  MapCell cabinet, wall;
  cabinet.normal = wall.normal = Eigen::Vector3d::UnitX();
  wall.mean = {5, 0, 0};
  constexpr double kWeight = 1.0 / (0.01 * 0.01), kCell_m = 0.004;
  std::vector<PatchVote> votes(100, PatchVote{&cabinet, kWeight});
  votes.push_back({&wall, kWeight});
  std::vector<double> alone = balanceVotes(votes, 0.0), shared = balanceVotes(votes, kCell_m);
  double together = 0;
  for (size_t i = 0; i < 100; ++i) together += shared[i] / alone[i] * kWeight;
  EXPECT_NEAR(together, 1.0 / (1.0 / (100 * kWeight) + kCell_m * kCell_m), 1e-6 * together);
  EXPECT_NEAR(shared.back() / alone.back(), 1.0 / 1.16, 1e-9) << "one patch errs by little more";
}

}  // namespace
}  // namespace sgraphs
