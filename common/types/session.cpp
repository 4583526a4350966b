#include "common/types/session.h"

#include "common/base/error.h"

namespace sgraphs {

std::string toString(OdometryMode mode) {
  switch (mode) {
    case OdometryMode::kLidar:
      return "lidar";
    case OdometryMode::kEncoder:
      return "encoder";
    case OdometryMode::kFused:
      return "fused";
  }
  throw std::logic_error("OdometryMode out of range");
}

OdometryMode parseOdometryMode(const std::string& text) {
  if (text == "lidar") return OdometryMode::kLidar;
  if (text == "encoder") return OdometryMode::kEncoder;
  if (text == "fused") return OdometryMode::kFused;
  throw UsageError("odometry '" + text + "' is unknown: use lidar, encoder or fused");
}

OdometryMode Session::odometryMode() const {
  if (odometry_mode.empty()) return has_odometry ? OdometryMode::kFused : OdometryMode::kLidar;
  return parseOdometryMode(odometry_mode);
}

}  // namespace sgraphs
