#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "perception/planes/facets.h"

namespace sgraphs {

// n.p + d = 0 in the keyframe's body, n towards the observer.
struct Hypothesis {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double d = 0;

  double distance(const Eigen::Vector3d& p) const { return normal.dot(p) + d; }
};

// Seeded sequential RANSAC over facets. A hypothesis is one facet, its place and its normal. A normal from
// some 0.3 m is not good enough for a whole wall, so a hypothesis is scored by the facets in a flat cone
// around it, and the best one is refitted to what lies within 0.8 m, 1.6 m, 3.2 m, … of it.
class PlaneSearch {
 public:
  // `facets` must outlive the search.
  PlaneSearch(const std::vector<Facet>& facets, const PlaneSearchConfig& config, double min_area_m2,
              uint64_t seed);

  // A plane among the facets that are not taken; nothing if none is left. Each facet is a seed of at most one
  // plane returned.
  std::optional<Hypothesis> next();

  // The facet belongs to a plane: it is out of the search.
  void take(int32_t facet);
  // The facet was in a segment that is no plane: no plane grows from it any more, but it may join one.
  void passOver(int32_t facet);

 private:
  enum class State : uint8_t { kFree, kNoSeed, kTaken };

  double score(const Facet& seed) const;
  void dropTaken();
  Hypothesis grow(const Facet& seed) const;
  bool agrees(const Facet& facet, const Eigen::Vector3d& normal) const;
  uint64_t random();

  const std::vector<Facet>& facets_;
  PlaneSearchConfig config_;
  double min_area_m2_, min_cos_;
  uint64_t random_state_;
  std::vector<State> state_;
  std::vector<int32_t> free_;   // facets not taken, in order
  std::vector<int32_t> seeds_;  // those of them not yet used as a seed
  // Of free_, for scoring, which is the inner loop of everything: mean, normal [m], area [unit_m2_], one row
  // each, so that the compiler takes several facets at a time. Areas are counted in integers: a sum of floats
  // would have to keep its order.
  std::array<std::vector<float>, 6> rows_;
  std::vector<int32_t> areas_;
  double unit_m2_ = 0;
};

}  // namespace sgraphs
