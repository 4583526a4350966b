#pragma once

#include <Eigen/Core>
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

  // What scoring reads of a facet that is not taken: it is the inner loop of everything.
  struct Candidate {
    Eigen::Vector3f mean, normal;
    float area_m2;
    int32_t facet;
  };

  double score(const Candidate& seed) const;
  Hypothesis grow(const Facet& seed) const;
  bool agrees(const Facet& facet, const Eigen::Vector3d& normal) const;
  uint64_t random();

  const std::vector<Facet>& facets_;
  PlaneSearchConfig config_;
  double min_area_m2_, min_cos_;
  uint64_t random_state_;
  std::vector<State> state_;
  std::vector<Candidate> free_;  // not taken, in order
  std::vector<size_t> seeds_;    // into free_: those not yet used as a seed
};

}  // namespace sgraphs
