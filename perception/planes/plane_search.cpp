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
  for (size_t i = 0; i < facets.size(); ++i) {
    free_.push_back(static_cast<int32_t>(i));
    if (i == 0 || facets[i].area_m2 < unit_m2_) unit_m2_ = facets[i].area_m2;
  }
  dropTaken();
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

void PlaneSearch::dropTaken() {
  std::erase_if(free_, [this](int32_t i) { return state_[static_cast<size_t>(i)] == State::kTaken; });
  for (std::vector<float>& row : rows_) row.clear();
  areas_.clear();
  for (const int32_t i : free_) {
    const Facet& facet = facets_[static_cast<size_t>(i)];
    for (Eigen::Index a = 0; a < 3; ++a) {
      rows_[static_cast<size_t>(a)].push_back(static_cast<float>(facet.mean(a)));
      rows_[static_cast<size_t>(a + 3)].push_back(static_cast<float>(facet.normal(a)));
    }
    areas_.push_back(static_cast<int32_t>(std::lround(facet.area_m2 / unit_m2_)));
  }
}

double PlaneSearch::score(const Facet& seed) const {
  const Eigen::Vector3f c = seed.mean.cast<float>(), n = seed.normal.cast<float>();
  const float *x = rows_[0].data(), *y = rows_[1].data(), *z = rows_[2].data(), *nx = rows_[3].data(),
              *ny = rows_[4].data(), *nz = rows_[5].data();
  const int32_t* area = areas_.data();
  const auto min_cos = static_cast<float>(min_cos_), gate_m = static_cast<float>(config_.distance_m);
  const size_t size = free_.size();
  int32_t sum = 0;
  for (size_t i = 0; i < size; ++i) {
    const float dx = x[i] - c.x(), dy = y[i] - c.y(), dz = z[i] - c.z();
    const float height = std::abs(n.x() * dx + n.y() * dy + n.z() * dz);
    const float above = height > gate_m ? height - gate_m : 0.0f;
    const bool in = (nx[i] * n.x() + ny[i] * n.y() + nz[i] * n.z() >= min_cos) & (height <= kMaxCone_m) &
                    (above * above <= kConeSlope * kConeSlope * (dx * dx + dy * dy + dz * dz));
    sum += in ? area[i] : 0;
  }
  return unit_m2_ * sum;
}

Hypothesis PlaneSearch::grow(const Facet& seed) const {
  Hypothesis plane{seed.normal, -seed.normal.dot(seed.mean)};
  double radius_m = kFirstRadius_m;
  for (int step = 0; step < kGrowthSteps; ++step, radius_m *= 2) {
    PlaneMoments moments;
    int facets = 0;
    for (const int32_t i : free_) {
      const Facet& facet = facets_[static_cast<size_t>(i)];
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
  dropTaken();
  const auto state = [this](int32_t facet) -> State& { return state_[static_cast<size_t>(facet)]; };
  for (int failures = 0; failures < config_.max_failures; ++failures) {
    seeds_.clear();
    for (const int32_t i : free_)
      if (state(i) == State::kFree) seeds_.push_back(i);
    if (seeds_.empty()) return std::nullopt;
    double best_m2 = 0;
    int32_t best = -1;
    for (int h = 0; h < config_.hypotheses; ++h) {
      const int32_t seed = seeds_[random() % seeds_.size()];
      if (state(seed) != State::kFree) continue;  // drawn and found wanting
      const double area_m2 = score(facets_[static_cast<size_t>(seed)]);
      if (area_m2 < min_area_m2_) state(seed) = State::kNoSeed;
      if (area_m2 <= best_m2) continue;
      best_m2 = area_m2;
      best = seed;
    }
    if (best_m2 < min_area_m2_) continue;
    state(best) = State::kNoSeed;
    return grow(facets_[static_cast<size_t>(best)]);
  }
  return std::nullopt;
}

}  // namespace sgraphs
