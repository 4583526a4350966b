#include "perception/rooms/min_cut.h"

#include <gtest/gtest.h>

#include <limits>

namespace sgraphs {
namespace {

struct Problem {
  std::vector<std::pair<double, double>> nodes;  // cost inside, outside
  struct Pair {
    size_t a, b;
    double cost;
  };
  std::vector<Pair> pairs;

  double costOf(const std::vector<bool>& inside) const {
    double cost = 0;
    for (size_t i = 0; i < nodes.size(); ++i) cost += inside[i] ? nodes[i].first : nodes[i].second;
    for (const Pair& p : pairs) cost += inside[p.a] && !inside[p.b] ? p.cost : 0;
    return cost;
  }
  std::vector<bool> solve() const {
    MinCut cut(nodes.size());
    for (size_t i = 0; i < nodes.size(); ++i) cut.addNode(i, nodes[i].first, nodes[i].second);
    for (const Pair& p : pairs) cut.addPair(p.a, p.b, p.cost);
    return cut.inside();
  }
};

TEST(MinCutTest, NodesAloneTakeTheCheaperSide) {
  const Problem problem{{{1, 2}, {2, 1}, {0, 5}}, {}};
  EXPECT_EQ(problem.solve(), (std::vector<bool>{true, false, true}));
}

TEST(MinCutTest, PairsHoldInOneDirection) {
  const Problem held{{{0, 3}, {1, 0}}, {{0, 1, 2.0}}};
  EXPECT_EQ(held.solve(), (std::vector<bool>{true, true}));
  const Problem free{{{0, 3}, {1, 0}}, {{1, 0, 2.0}}};
  EXPECT_EQ(free.solve(), (std::vector<bool>{true, false}));
}

TEST(MinCutTest, NoSplitOfTenNodesIsCheaper) {
  for (int seed = 0; seed < 20; ++seed) {
    // Costs from a linear congruence: the same on every machine.
    uint32_t state = 12345u + 977u * static_cast<uint32_t>(seed);
    const auto next = [&state]() {
      state = state * 1664525u + 1013904223u;
      return static_cast<double>(state >> 16) / 65536.0;
    };
    Problem problem;
    for (int i = 0; i < 10; ++i) problem.nodes.emplace_back(next(), next());
    for (size_t a = 0; a < 10; ++a)
      for (size_t b = 0; b < 10; ++b)
        if (a != b && next() < 0.4) problem.pairs.push_back({a, b, 0.5 * next()});
    double least = std::numeric_limits<double>::infinity();
    for (unsigned bits = 0; bits < 1024; ++bits) {
      std::vector<bool> inside(10);
      for (size_t i = 0; i < 10; ++i) inside[i] = (bits >> i & 1u) != 0;
      least = std::min(least, problem.costOf(inside));
    }
    EXPECT_NEAR(problem.costOf(problem.solve()), least, 1e-9);
  }
}

}  // namespace
}  // namespace sgraphs
