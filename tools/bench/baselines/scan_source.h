#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/geometry/se3.h"
#include "common/types/lidar_scan.h"

namespace sgraphs::bench {

// A scan of a log as a baseline sees it.
struct RecordedScan {
  const LidarScan& scan;
  SE3 T_body_lidar;
  std::optional<SE3> T_odom_body;  // the legs' odometry at the scan's end; none if it was not asked for
};

// Calls `visit` for every scan of the log, in order, decoded by the very node that our own odometry runs in.
// Throws Error if the log cannot be read, holds no SESSION, or has no odometry where `with_legs` asks for it.
void forEachScan(const std::string& log, bool with_legs,
                 const std::function<void(const RecordedScan&)>& visit);

}  // namespace sgraphs::bench
