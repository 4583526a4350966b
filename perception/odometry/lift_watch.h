#pragma once

#include <array>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/se3.h"
#include "common/types/lidar_scan.h"
#include "perception/odometry/odometry_config.h"

namespace sgraphs {

// Tells a ride in a lift by what a standing robot sees. Neither LiDAR nor legs feel the ride itself: the
// walls of the car come along. But a door closes while the robot stands, for some seconds all that is seen is
// a small closed space, and then a door opens. Whoever shuts the robot in a cupboard of a car's size and lets
// it out is taken for a lift, too.
class LiftWatch {
 public:
  explicit LiftWatch(const LiftConfig& config) : config_(config) {}

  enum class Event {
    kNone,
    kShutIn,  // the door has been closed long enough: what has been seen since is the car's
    kLetOut   // the door opens: nobody knows on which floor
  };
  // The next scan; its motion as it was predicted: a pose is needed that is right while the robot stands.
  Event step(const LidarScan& scan, const std::vector<int32_t>& kept, const SE3& T_body_lidar,
             const SE3& T_odom_body);

  // All but the configuration; see StateArchive.
  void visitState(auto& archive) {
    archive(anchor_, still_since_, closed_since_, closed_, shut_in_, looked_, view_m_);
  }

 private:
  static constexpr size_t kSectors = 72;
  // How far is seen in each direction from above, from where the robot came to stand [m]; 0: nothing seen.
  using View = std::array<float, kSectors>;
  View viewOf(const LidarScan& scan, const std::vector<int32_t>& kept, const SE3& T_odom_lidar) const;
  bool encloses(const View& view) const;
  void close(Time time, const View& view);
  Event open();

  LiftConfig config_;
  Eigen::Vector3d anchor_ = Eigen::Vector3d::Zero();  // in odom: where the robot came to stand
  Time still_since_;
  Time closed_since_;
  bool closed_ = false;
  bool shut_in_ = false;
  bool looked_ = false;  // since it came to stand
  View view_m_{};        // when it closed
};

}  // namespace sgraphs
