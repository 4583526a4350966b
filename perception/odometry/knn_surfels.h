#pragma once

#include <optional>

#include "perception/odometry/surfel.h"

namespace sgraphs {

// First and second moments of a patch about a nearby origin, which keeps the digits.
class PatchMoments {
 public:
  explicit PatchMoments(const Eigen::Vector3d& origin);
  void add(const Eigen::Vector3d& p);
  // The patch in lidar, normal towards the lidar's origin; nothing if it is too small, too thick or too
  // narrow.
  std::optional<Surfel> surfel(const SurfelConfig& config, int32_t time_us) const;

 private:
  Eigen::Vector3d origin_;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares_ = Eigen::Matrix3d::Zero();
  int count_ = 0;
};

// Patches of a scan without rings, in lidar: the returns are thinned to an even density first, because the
// nearest neighbours of a raw return all lie on its own scan line.
std::vector<Surfel> knnSurfels(const LidarScan& scan, const std::vector<int32_t>& kept,
                               const SurfelConfig& config);

}  // namespace sgraphs
