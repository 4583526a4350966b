#pragma once

#include <memory>
#include <optional>
#include <span>

#include "common/base/state_archive.h"
#include "common/types/keyframe.h"
#include "common/types/lidar_scan.h"
#include "common/types/session.h"
#include "perception/odometry/odometry_config.h"

namespace sgraphs {

// Scans, and the legs' odometry where the mode asks for it, become poses and keyframes. A pure function of
// its inputs so far: no clock, no file; the number of threads does not change a bit of the output.
//
// In two steps, because a robot waits for its pose and nobody waits for a keyframe, whose cloud and
// registration against the keyframes before take four times as long as a scan's pose.
class Odometry {
 public:
  Odometry(const OdometryConfig& config, OdometryMode mode, const SE3& T_body_lidar);
  ~Odometry();

  // The next scan, in order of time. `body_odometry`: the legs' samples from the last one at or before
  // scan.begin to the first one at or after scan.end, as far as they exist; empty in lidar mode. Nothing is
  // returned for a scan that cannot be used (fewer than the configured number of points): the caller counts
  // it.
  std::optional<OdometryEstimate> step(const LidarScan& scan, std::span<const BodyOdometry> body_odometry);

  // The keyframe that the last scan became; nothing unless its estimate said so, and only once. What the
  // caller leaves here the next step makes for itself: what follows is the same.
  std::optional<Keyframe> takeKeyframe();

  // All that it knows of its inputs so far; not the configuration, mode and mount. A keyframe must have been
  // taken before: throws std::logic_error.
  void visitState(StateArchive& archive);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgraphs
