#include "perception/planes/plane_search.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sgraphs {
namespace {

// Widening of the cone in which a facet's normal is believed, and its largest half thickness.
constexpr float kConeSlope = 0.03f;
constexpr float kMaxCone_m = 0.20f;
constexpr double kFirstRadius_m = 0.8;
constexpr int kGrowthSteps = 6;

}  // namespace

PlaneSearch::PlaneSearch(const std::vector<Facet>& facets, const PlaneSearchConfig& config,
                         double min_area_m2, uint64_t seed)
    : facets_(facets),
      config_(config),
      min_area_m2_(min_area_m2),
      min_cos_(std::cos(config.normal_angle_rad)),
      random_state_(seed),
      state_(facets.size(), State::kFree) {
  for (size_t i = 0; i < facets.size(); ++i)
    free_.push_back({facets[i].mean.cast<float>(), facets[i].normal.cast<float>(),
                     static_cast<float>(facets[i].area_m2), static_cast<int32_t>(i)});
}

// SplitMix64 (Steele et al., "Fast splittable pseudorandom number generators", 2014).
uint64_t PlaneSearch::random() {
  uint64_t z = (random_state_ += 0x9E3779B97F4A7C15ull);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

void PlaneSearch::take(int32_t facet) {
  state_[static_cast<size_t>(facet)] = State::kTaken;
}

void PlaneSearch::passOver(int32_t facet) {
  State& state = state_[static_cast<size_t>(facet)];
  if (state == State::kFree) state = State::kNoSeed;
}

bool PlaneSearch::agrees(const Facet& facet, const Eigen::Vector3d& normal) const {
  return facet.normal.dot(normal) >= min_cos_;
}

double PlaneSearch::score(const Candidate& seed) const {
  const auto min_cos = static_cast<float>(min_cos_), gate_m = static_cast<float>(config_.distance_m);
  double area_m2 = 0;
  for (const Candidate& facet : free_) {
    if (facet.normal.dot(seed.normal) < min_cos) continue;
    const Eigen::Vector3f delta = facet.mean - seed.mean;
    const float height = std::abs(seed.normal.dot(delta));
    if (height > kMaxCone_m) continue;
    const float above = std::max(height - gate_m, 0.0f);
    if (above * above <= kConeSlope * kConeSlope * delta.squaredNorm()) area_m2 += facet.area_m2;
  }
  return area_m2;
}

Hypothesis PlaneSearch::grow(const Facet& seed) const {
  Hypothesis plane{seed.normal, -seed.normal.dot(seed.mean)};
  double radius_m = kFirstRadius_m;
  for (int step = 0; step < kGrowthSteps; ++step, radius_m *= 2) {
    PlaneMoments moments;
    int facets = 0;
    for (const Candidate& candidate : free_) {
      const Facet& facet = facets_[static_cast<size_t>(candidate.facet)];
      if (std::abs(plane.distance(facet.mean)) > config_.distance_m || !agrees(facet, plane.normal)) continue;
      if ((facet.mean - seed.mean).squaredNorm() > radius_m * radius_m) continue;
      moments.add(facet.moments);
      ++facets;
    }
    if (facets < 3) continue;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moments.covariance());
    Eigen::Vector3d normal = eigen.eigenvectors().col(0);
    if (normal.dot(plane.normal) < 0) normal = -normal;
    plane = {normal, -normal.dot(moments.mean())};
  }
  return plane;
}

std::optional<Hypothesis> PlaneSearch::next() {
  const auto state = [this](const Candidate& c) -> State& { return state_[static_cast<size_t>(c.facet)]; };
  std::erase_if(free_, [&](const Candidate& c) { return state(c) == State::kTaken; });
  for (int failures = 0; failures < config_.max_failures; ++failures) {
    seeds_.clear();
    for (size_t i = 0; i < free_.size(); ++i)
      if (state(free_[i]) == State::kFree) seeds_.push_back(i);
    if (seeds_.empty()) return std::nullopt;
    double best_m2 = 0;
    const Candidate* best = nullptr;
    for (int h = 0; h < config_.hypotheses; ++h) {
      const Candidate& seed = free_[seeds_[random() % seeds_.size()]];
      if (state(seed) != State::kFree) continue;  // drawn and found wanting
      const double area_m2 = score(seed);
      if (area_m2 < min_area_m2_) state(seed) = State::kNoSeed;
      if (area_m2 > best_m2) {
        best_m2 = area_m2;
        best = &seed;
      }
    }
    if (best_m2 < min_area_m2_) continue;
    state(*best) = State::kNoSeed;
    return grow(facets_[static_cast<size_t>(best->facet)]);
  }
  return std::nullopt;
}

}  // namespace sgraphs
