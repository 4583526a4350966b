#pragma once

#include <optional>

#include "common/base/time.h"

namespace sgraphs {

// Stamps of the robot's clock become stamps of the host's: host = robot - skew. A new skew is approached at a
// bounded rate, so that stamps never jump with a clock's new estimate, and every stamp is later than the one
// before.
class StampMapper {
 public:
  // max_slew_ppm: microseconds of skew per second of the robot's time, below 1e6. A skew further than
  // max_slew from the one in force is a clock that was set, not one that drifts: it is taken at once.
  StampMapper(double max_slew_ppm, Duration max_slew) : slew_(max_slew_ppm * 1e-6), max_slew_(max_slew) {}

  // Returns whether the skew was taken at once, in place of another one.
  bool setSkew(Duration skew);

  // Host time of a robot's stamp with the skew in force, without effect on later stamps.
  Time toHost(Time robot) const { return robot - skew_; }

  // Host time of the next sample; nothing if it would not come after the sample before. setSkew comes first.
  std::optional<Time> step(Time robot);

  Duration skewInForce() const { return skew_; }

 private:
  double slew_;
  Duration max_slew_;
  Duration skew_;  // in force
  Duration target_;
  bool has_skew_ = false;
  std::optional<Time> last_robot_, last_host_;
};

}  // namespace sgraphs
