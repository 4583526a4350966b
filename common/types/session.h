#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/se3.h"

namespace sgraphs {

// Where the odometry factor comes from (contract.md, `--odometry`).
enum class OdometryMode { kLidar, kEncoder, kFused };

// "lidar", "encoder" or "fused"; parse throws UsageError for another word.
std::string toString(OdometryMode mode);
OdometryMode parseOdometryMode(const std::string& text);

// What a run is made of; a log is complete by itself because it carries one.
struct Session {
  int64_t id = 0;
  Time start;
  std::string writer;
  std::vector<std::string> stages;  // empty: the default of the program that plays the log
  std::string odometry_mode;        // empty: fused where odometry is recorded, else lidar
  bool has_odometry = false;
  SE3 T_body_lidar;
  std::string config_digest;

  OdometryMode odometryMode() const;
};

// One sample of the legs' odometry.
struct BodyOdometry {
  Time time;
  SE3 T_odom_body;
  std::optional<Vector6d> twist_body = {};  // [m/s, rad/s] in body; nothing if the source gave none

  // What is reckoned with; the velocity is only passed on.
  void visitState(auto& archive) { archive(time, T_odom_body); }
};

}  // namespace sgraphs
