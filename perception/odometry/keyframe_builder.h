#pragma once

#include <vector>

#include "common/types/keyframe.h"
#include "perception/odometry/registration.h"
#include "perception/odometry/surfel.h"

namespace sgraphs {

// Aggregates the scans since the last keyframe: deskewed, thinned to one centroid per voxel and viewing
// direction (the two faces of a thin wall stay apart), with the viewpoint and the number of returns behind
// each centroid.
class KeyframeBuilder {
 public:
  KeyframeBuilder(const KeyframeConfig& config, const SE3& T_body_lidar);

  // Adds a scan whose motion is known. Standing still adds nothing new: then a scan is left out.
  void add(const LidarScan& scan, const std::vector<int32_t>& kept, const std::vector<Surfel>& surfels,
           const ScanMotion& motion);

  // Whether the pose calls for a keyframe by distance or rotation since the last one.
  bool due(const SE3& T_odom_body) const;

  // Cloud and viewpoints in the frame of T_odom_body, which becomes the last keyframe's pose; begins the next
  // one. The patches of the same scans, in the keyframe's body, go to `surfels`.
  Keyframe build(const SE3& T_odom_body, std::vector<Surfel>& surfels);

  // Leaves what has been added since the last keyframe out of the next.
  void drop();

  // All but the configuration; see StateArchive.
  void visitState(auto& archive) {
    archive(has_keyframe_, T_odom_keyframe_, T_odom_scan_, voxels_, index_, surfels_odom_);
  }

 private:
  struct Voxel {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();  // of positions in odom, relative to the voxel's corner
    Eigen::Vector3f corner = Eigen::Vector3f::Zero();
    uint32_t count = 0;
    uint8_t scan = 0;

    void visitState(auto& archive) { archive(sum, corner, count, scan); }
  };
  bool adds(const SE3& T_odom_body) const;
  void addPoint(const Eigen::Vector3d& point_odom, const Eigen::Vector3d& viewpoint_odom, uint8_t scan);

  KeyframeConfig config_;
  SE3 T_body_lidar_;
  bool has_keyframe_ = false;
  SE3 T_odom_keyframe_;
  std::vector<SE3> T_odom_scan_;
  std::vector<Voxel> voxels_;
  VoxelIndex index_;
  std::vector<Surfel> surfels_odom_;
};

}  // namespace sgraphs
