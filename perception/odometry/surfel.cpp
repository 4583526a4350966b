#include "perception/odometry/surfel.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <optional>

#include "perception/odometry/knn_surfels.h"
#include "perception/odometry/scan_image.h"

namespace sgraphs {
namespace {

// Two returns can lie on one surface if they are no farther apart than a grazing surface would put them.
bool adjacent(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float reach) {
  return (a - b).squaredNorm() < reach * reach;
}

bool insideBody(const Eigen::Vector3f& p, const PrefilterConfig& c) {
  return p.x() > c.body_min_x_m && p.x() < c.body_max_x_m && p.y() > c.body_min_y_m &&
         p.y() < c.body_max_y_m && p.z() > c.body_min_z_m && p.z() < c.body_max_z_m;
}

// Whether any return beside this one, on its ring or the next ones, may belong to the same surface.
bool hasNeighbour(const LidarScan& scan, const ScanImage& image, const LidarPoint& p, int column) {
  const float range = p.position_lidar.norm();
  const float reach = 0.15f + 0.05f * range;
  for (int dr = -1; dr <= 1; ++dr) {
    const int ring = p.ring + dr;
    if (ring < 0 || ring >= image.rings()) continue;
    for (int dc = -2; dc <= 2; ++dc) {
      if (dr == 0 && dc == 0) continue;
      const int32_t other = image.at(ring, column + dc);
      if (other >= 0 &&
          adjacent(p.position_lidar, scan.points[static_cast<size_t>(other)].position_lidar, reach))
        return true;
    }
  }
  return false;
}

// Mean, covariance and normal of the patch about one return.
std::optional<Surfel> patchAt(const LidarScan& scan, const ScanImage& image, int ring, int column,
                              const SurfelConfig& config) {
  const int32_t centre_index = image.at(ring, column);
  if (centre_index < 0) return std::nullopt;
  const LidarPoint& centre = scan.points[static_cast<size_t>(centre_index)];
  const double range = centre.position_lidar.norm();
  const double step_m = range * 2.0 * M_PI / image.columns();
  const int half = std::clamp(static_cast<int>(config.patch_radius_m / std::max(step_m, 1e-6)), 2,
                              config.max_half_columns);
  // A surface seen at grazing incidence spreads its returns along the ray: rings lie 2 degrees apart.
  const float reach = static_cast<float>(0.15 + 0.25 * range);
  PatchMoments moments(centre.position_lidar.cast<double>());
  int rings = 0;
  for (int r = std::max(0, ring - 1); r <= std::min(image.rings() - 1, ring + 1); ++r) {
    bool any = false;
    for (int c = column - half; c <= column + half; ++c) {
      const int32_t i = image.at(r, c);
      if (i < 0) continue;
      const Eigen::Vector3f& p = scan.points[static_cast<size_t>(i)].position_lidar;
      if (!adjacent(p, centre.position_lidar, reach)) continue;
      moments.add(p.cast<double>());
      any = true;
    }
    rings += any;
  }
  if (rings < 2) return std::nullopt;
  return moments.surfel(config, centre.time_us);
}

}  // namespace

std::vector<int32_t> prefilter(const LidarScan& scan, const SE3& T_body_lidar,
                               const PrefilterConfig& config) {
  std::vector<int32_t> kept;
  kept.reserve(scan.points.size());
  const Eigen::Matrix3f R = T_body_lidar.matrix3().cast<float>();
  const Eigen::Vector3f t = T_body_lidar.translation.cast<float>();
  const auto min2 = static_cast<float>(config.min_range_m * config.min_range_m);
  const auto max2 = static_cast<float>(config.max_range_m * config.max_range_m);
  for (size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3f& p = scan.points[i].position_lidar;
    const float r2 = p.squaredNorm();
    // A ring beyond the scan's own has no place in its image.
    if (scan.num_rings > 0 && scan.points[i].ring >= scan.num_rings) continue;
    // Written so that NaN fails.
    if (!(r2 >= min2 && r2 <= max2) || insideBody(R * p + t, config)) continue;
    kept.push_back(static_cast<int32_t>(i));
  }
  if (scan.num_rings == 0) return kept;
  const ScanImage image(scan, kept);
  if (image.columns() == 0) return kept;
  std::vector<int32_t> surfaces;
  surfaces.reserve(kept.size());
  for (const int32_t i : kept) {
    const LidarPoint& p = scan.points[static_cast<size_t>(i)];
    if (hasNeighbour(scan, image, p, image.columnOf(p))) surfaces.push_back(i);
  }
  return surfaces;
}

std::vector<Surfel> extractSurfels(const LidarScan& scan, const std::vector<int32_t>& kept,
                                   const SE3& T_body_lidar, const SurfelConfig& config, int threads) {
  std::vector<Surfel> surfels;
  if (scan.num_rings == 0) {
    surfels = knnSurfels(scan, kept, config);
  } else {
    const ScanImage image(scan, kept);
    const int per_ring = (image.columns() + config.column_stride - 1) / config.column_stride;
    // One slot per candidate, filled by whichever thread, read in order.
    std::vector<std::optional<Surfel>> slots(static_cast<size_t>(image.rings() * per_ring));
    const auto fill = [&](int ring) {
      for (int k = 0; k < per_ring; ++k)
        // Staggered from ring to ring, so that the patches do not stand in vertical lines.
        slots[static_cast<size_t>(ring * per_ring + k)] =
            patchAt(scan, image, ring, (k * config.column_stride + ring * 3) % image.columns(), config);
    };
    if (threads > 1)
      tbb::parallel_for(0, image.rings(), fill);
    else
      for (int ring = 0; ring < image.rings(); ++ring) fill(ring);
    for (const std::optional<Surfel>& slot : slots)
      if (slot) surfels.push_back(*slot);
  }
  const Eigen::Matrix3d R = T_body_lidar.matrix3();
  for (Surfel& s : surfels) {
    s.mean = R * s.mean + T_body_lidar.translation;
    s.normal = R * s.normal;
    s.covariance = R * s.covariance * R.transpose();
  }
  return surfels;
}

double normalVariance(double thickness2, double width2, double count) {
  const double gap2 = width2 - thickness2;
  if (gap2 <= 0) return std::numeric_limits<double>::max();
  return thickness2 * width2 / (count * gap2 * gap2);
}

PatchMoments::PatchMoments(const Eigen::Vector3d& origin) : origin_(origin) {}

void PatchMoments::add(const Eigen::Vector3d& p) {
  const Eigen::Vector3d d = p - origin_;
  sum_ += d;
  squares_.noalias() += d * d.transpose();
  ++count_;
}

std::optional<Surfel> PatchMoments::surfel(const SurfelConfig& config, int32_t time_us) const {
  if (count_ < config.min_points) return std::nullopt;
  Surfel s;
  const Eigen::Vector3d mean = sum_ / count_;
  s.covariance = squares_ / count_ - mean * mean.transpose();
  s.mean = origin_ + mean;
  s.count = count_;
  s.time_us = time_us;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(s.covariance);
  const double thickness2 = std::max(eigen.eigenvalues()[0], 0.0);
  const double width2 = eigen.eigenvalues()[1];
  if (!(thickness2 < config.max_thickness_m * config.max_thickness_m) || !(width2 > 1e-6))
    return std::nullopt;
  // With at least the sensor's own noise of 1 cm.
  const double noise2 = std::max(thickness2, 1e-4);
  if (normalVariance(noise2, width2, count_) > config.max_normal_sigma_rad * config.max_normal_sigma_rad)
    return std::nullopt;
  s.normal = eigen.eigenvectors().col(0).normalized();
  if (s.normal.dot(s.mean) > 0) s.normal = -s.normal;  // towards the sensor at the lidar's origin
  s.variance_m2 = noise2 / count_;
  return s;
}

}  // namespace sgraphs
