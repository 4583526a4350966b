#pragma once

#include <memory>

#include "tools/bench/baselines/point_filter.h"

namespace sgraphs::bench {

struct ScanMatch {
  SE3 T_target_source;
  bool converged = false;
};

// Registration of one cloud to another, both in their own body frames; PCL stays out of the header.
class ScanRegistration {
 public:
  virtual ~ScanRegistration() = default;
  virtual void setTarget(const Points& target) = 0;
  virtual ScanMatch align(const Points& source, const SE3& T_target_source_guess) = 0;
};

// Generalised ICP. Reach and NDT's epsilon are the best of eleven settings tried on one recording
// (small_office, seed 1), one change at a time: ATE 0.05 m where HDL-SLAM's reach of 2 m gave 0.10 m.
struct GicpConfig {
  double max_correspondence_m = 0.5;
  double epsilon = 0.01;  // of the transform, where iterations end
  int max_iterations = 64;
  int neighbours = 20;  // for a point's covariance
};
std::unique_ptr<ScanRegistration> makeGicp(const GicpConfig& config = {});

// Normal distributions transform.
struct NdtConfig {
  double resolution_m = 1.0;
  double epsilon = 0.001;  // ATE 0.26 m where 0.01 gave 3.1 m
  double step_m = 0.1;
  int max_iterations = 64;
};
std::unique_ptr<ScanRegistration> makeNdt(const NdtConfig& config = {});

// Mean squared distance [m^2] from each source point to its nearest target point, those beyond max_range_m
// left out; infinite if none is nearer. HDL-SLAM judges edges and loops by it.
double fitness_m2(const Points& target, const Points& source, const SE3& T_target_source, double max_range_m);

}  // namespace sgraphs::bench
