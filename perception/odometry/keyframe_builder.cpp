#include "perception/odometry/keyframe_builder.h"

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

constexpr size_t kMaxScans = 250;      // the scan index of a point is a byte
constexpr size_t kStandingScans = 30;  // of a robot that does not move, at most
constexpr double kMoved_m = 0.05;
constexpr double kMoved_rad = 0.05;
constexpr size_t kSurfelStride = 3;   // every third patch of a scan serves keyframe-to-keyframe registration
constexpr int32_t kSamePose_us = 60;  // one firing sequence

bool moved(const SE3& a, const SE3& b, double distance_m, double angle_rad) {
  const SE3 d = a.inverse() * b;
  return d.translation.norm() >= distance_m || so3Log(d.rotation).norm() >= angle_rad;
}

// The side from which a point is seen, as one of six directions.
uint64_t viewClass(const Eigen::Vector3d& ray) {
  int axis = 0;
  ray.cwiseAbs().maxCoeff(&axis);
  return static_cast<uint64_t>(2 * axis + (ray[axis] < 0));
}

}  // namespace

KeyframeBuilder::KeyframeBuilder(const KeyframeConfig& config, const SE3& T_body_lidar)
    : config_(config), T_body_lidar_(T_body_lidar) {}

bool KeyframeBuilder::adds(const SE3& T_odom_body) const {
  if (T_odom_scan_.size() < kStandingScans) return true;
  return T_odom_scan_.size() < kMaxScans && moved(T_odom_scan_.back(), T_odom_body, kMoved_m, kMoved_rad);
}

void KeyframeBuilder::addPoint(const Eigen::Vector3d& point, const Eigen::Vector3d& viewpoint, uint8_t scan) {
  const Eigen::Vector3d cell = (point / config_.voxel_m).array().floor();
  const uint64_t key = VoxelIndex::pack(static_cast<int64_t>(cell.x()), static_cast<int64_t>(cell.y()),
                                        static_cast<int64_t>(cell.z()), viewClass(point - viewpoint));
  int32_t i = index_.find(key);
  if (i < 0) {
    i = static_cast<int32_t>(voxels_.size());
    index_.insert(key, i);
    Voxel voxel;
    voxel.corner = (cell * config_.voxel_m).cast<float>();
    voxel.scan = scan;
    voxels_.push_back(voxel);
  }
  Voxel& voxel = voxels_[static_cast<size_t>(i)];
  voxel.sum += point.cast<float>() - voxel.corner;
  ++voxel.count;
}

void KeyframeBuilder::add(const LidarScan& scan, const std::vector<int32_t>& kept,
                          const std::vector<Surfel>& surfels, const ScanMotion& motion) {
  const SE3& T_odom_body = motion.T_odom_body.back();
  if (!adds(T_odom_body)) return;
  const auto scan_index = static_cast<uint8_t>(T_odom_scan_.size());
  T_odom_scan_.push_back(T_odom_body);
  int32_t pose_time_us = 1;  // no firing has a positive time
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  for (const int32_t index : kept) {
    const LidarPoint& p = scan.points[static_cast<size_t>(index)];
    if (pose_time_us > 0 || std::abs(p.time_us - pose_time_us) > kSamePose_us) {
      const SE3 T = motion.at(p.time_us) * T_body_lidar_;
      R = T.matrix3();
      t = T.translation;
      pose_time_us = p.time_us;
    }
    addPoint(R * p.position_lidar.cast<double>() + t, t, scan_index);
  }
  for (size_t i = scan_index % kSurfelStride; i < surfels.size(); i += kSurfelStride) {
    Surfel s = surfels[i];
    const SE3 T = motion.at(s.time_us);
    const Eigen::Matrix3d R_odom = T.matrix3();
    s.mean = T * s.mean;
    s.normal = R_odom * s.normal;
    s.covariance = R_odom * s.covariance * R_odom.transpose();
    s.time_us = 0;
    surfels_odom_.push_back(s);
  }
}

bool KeyframeBuilder::due(const SE3& T_odom_body) const {
  return !has_keyframe_ || moved(T_odom_keyframe_, T_odom_body, config_.distance_m, config_.angle_rad);
}

Keyframe KeyframeBuilder::build(const SE3& T_odom_body, std::vector<Surfel>& surfels) {
  has_keyframe_ = true;
  T_odom_keyframe_ = T_odom_body;
  const SE3 T_keyframe_odom = T_odom_body.inverse();
  // The keyframe's own pose ends the list, also where its scan was left out.
  if (T_odom_scan_.empty() || moved(T_odom_scan_.back(), T_odom_body, 1e-9, 1e-9))
    T_odom_scan_.push_back(T_odom_body);
  Keyframe keyframe;
  keyframe.T_odom_body = T_odom_body;
  keyframe.T_body_lidar = T_body_lidar_;
  for (const SE3& T : T_odom_scan_) keyframe.T_keyframe_body.push_back(T_keyframe_odom * T);
  keyframe.points.reserve(voxels_.size());
  for (const Voxel& voxel : voxels_) {
    const Eigen::Vector3d centroid =
        (voxel.corner + voxel.sum / static_cast<float>(voxel.count)).cast<double>();
    KeyframePoint p;
    p.position_body = (T_keyframe_odom * centroid).cast<float>();
    p.scan = voxel.scan;
    p.count = static_cast<uint8_t>(std::min<uint32_t>(voxel.count, 255));
    keyframe.points.push_back(p);
  }
  const Eigen::Matrix3d R = T_keyframe_odom.matrix3();
  surfels.clear();
  surfels.reserve(surfels_odom_.size());
  for (Surfel s : surfels_odom_) {
    s.mean = T_keyframe_odom * s.mean;
    s.normal = R * s.normal;
    s.covariance = R * s.covariance * R.transpose();
    surfels.push_back(s);
  }
  drop();
  return keyframe;
}

void KeyframeBuilder::drop() {
  T_odom_scan_.clear();
  voxels_.clear();
  index_.clear();
  surfels_odom_.clear();
}

}  // namespace sgraphs
