#pragma once

#include <optional>
#include <span>
#include <string>

#include "common/types/lidar_scan.h"
#include "drivers/recording/ros/ros_messages.h"

namespace sgraphs {

// Sweeps out of sensor_msgs/PointCloud2 of any driver: x, y, z in `float32` or `float64`; firing times, if
// there is a field `time`, `t`, `timestamp` or `offset_time`, in seconds or nanoseconds, absolute or relative
// to the header's stamp; `ring`, if it is there. The unit is told by the first sweep whose times tell it.
class SweepFromCloud {
 public:
  // Points that are not finite, or at the sensor itself (no return), are left out. The scan's `sequence` is
  // left to the caller. Throws Error naming the field that is missing or cannot be understood, WireError if
  // the data are shorter than the cloud's own figures.
  LidarScan step(const RosPointCloud& cloud);

  // Name of the field with the firing times; empty: the last sweep had none and counts as deskewed to its
  // stamp.
  const std::string& timeField() const { return time_field_; }

 private:
  enum class Unit { kSeconds, kNanoseconds };
  void learnUnit(bool whole_numbers, double least, double greatest);
  // times: of scan.points, as the field says; scan.end is the header's stamp until then.
  void setTimes(std::span<const double> times, bool whole_numbers, LidarScan& scan);

  std::string time_field_;
  std::optional<Unit> unit_;
};

}  // namespace sgraphs
