#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/se3.h"

namespace sgraphs {

enum class RelativePoseKind { kOdometry = 0, kNeighbour = 1, kLoop = 2 };

// A measured transform between two keyframes' bodies.
struct RelativePose {
  RelativePoseKind kind = RelativePoseKind::kOdometry;
  KeyframeId from;
  KeyframeId to;
  SE3 T_from_to;
  Matrix6d covariance = Matrix6d::Identity();  // of the right perturbation: translation [m], rotation [rad]
  bool registered = false;  // made from the very scans that the keyframes' planes are made from
};

// A height that is known no better than this is not measured [m].
inline constexpr double kOpenHeight_m = 5.0;

// A ride in a lift: all is known of it but the height. Bodies stand upright.
inline bool leavesHeightOpen(const RelativePose& z) {
  const double vertical_m2 = z.covariance(2, 2), horizontal_m2 = z.covariance(0, 0) + z.covariance(1, 1);
  return z.kind == RelativePoseKind::kOdometry && vertical_m2 > kOpenHeight_m * kOpenHeight_m &&
         vertical_m2 > horizontal_m2;
}

// One voxel centroid of a keyframe's aggregated cloud.
struct KeyframePoint {
  Eigen::Vector3f position_body = Eigen::Vector3f::Zero();  // in the keyframe's body frame [m]
  uint8_t scan = 0;                                         // index into Keyframe::T_keyframe_body
  uint8_t count = 1;  // raw points behind the centroid, saturated at 255
};

// The deskewed, thinned aggregate of the scans since the previous keyframe, and what was measured of its
// pose.
struct Keyframe {
  KeyframeId id;
  Time time;         // end of the keyframe's scan
  int64_t scan = 0;  // the scan that became the keyframe
  SE3 T_odom_body;
  std::vector<RelativePose> relative_poses;           // against earlier keyframes; none for the first
  Eigen::Vector3d up_body = Eigen::Vector3d::Zero();  // unit vector; zero if unknown
  double up_sigma_rad = 0;                            // per horizontal axis; 0 if unknown
  std::vector<SE3> T_keyframe_body;                   // of each scan in the cloud; the last is the identity
  SE3 T_body_lidar;  // viewpoint of scan i: T_keyframe_body[i] * T_body_lidar * 0
  std::vector<KeyframePoint> points;
};

// Pose of the body after one scan, as ODOMETRY carries it.
struct OdometryEstimate {
  Time time;  // end of the scan
  int64_t scan = 0;
  SE3 T_odom_body;
  Vector6d twist_body = Vector6d::Zero();      // [m/s, rad/s], in body, at the scan's end
  Matrix6d covariance = Matrix6d::Identity();  // of the motion since the previous scan
  double inlier_share = -1;                    // of the scan's surfels; -1: nothing was registered
  double residual_rms_m = -1;
  int num_degenerate = 0;  // directions of motion that the LiDAR could not see
  bool extrapolated = false;
  KeyframeId keyframe;  // newest keyframe at the end of this scan
  bool is_keyframe = false;
};

}  // namespace sgraphs
