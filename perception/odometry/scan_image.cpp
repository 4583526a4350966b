#include "perception/odometry/scan_image.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sgraphs {
namespace {

constexpr int kAzimuthColumns = 1800;  // 0.2 degrees, the VLP-16's step at 600 rpm

int azimuthColumn(const Eigen::Vector3f& p) {
  const double turn = std::atan2(p.y(), p.x()) / (2.0 * std::numbers::pi);
  // Clockwise, as the sensor turns.
  return static_cast<int>((0.5 - turn) * kAzimuthColumns) % kAzimuthColumns;
}

}  // namespace

ScanImage::ScanImage(const LidarScan& scan, const std::vector<int32_t>& kept) : rings_(scan.num_rings) {
  uint16_t last_column = 0;
  for (const LidarPoint& p : scan.points) last_column = std::max(last_column, p.column);
  by_azimuth_ = last_column == 0;
  columns_ = by_azimuth_ ? kAzimuthColumns : last_column + 1;
  cells_.assign(static_cast<size_t>(rings_) * static_cast<size_t>(columns_), -1);
  for (const int32_t index : kept) {
    const LidarPoint& p = scan.points[static_cast<size_t>(index)];
    const int column = columnOf(p);
    // Of two returns of one firing the stronger or later stays, whichever comes last in the scan.
    cells_[static_cast<size_t>(p.ring) * static_cast<size_t>(columns_) + static_cast<size_t>(column)] = index;
  }
}

int ScanImage::columnOf(const LidarPoint& p) const {
  return by_azimuth_ ? azimuthColumn(p.position_lidar) : p.column;
}

}  // namespace sgraphs
