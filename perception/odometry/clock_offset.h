#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "common/base/time.h"
#include "common/types/session.h"

namespace sgraphs {

class ConfigVisitor;

struct ClockOffsetConfig {
  bool estimate = true;
  double max_offset_s = 0.3;
  double trusted_sigma_s = 0.003;
  double least_offset_s = 0.01;

  void visit(ConfigVisitor& v);
};

// The constant offset between the legs' clock and the LiDAR's, from how fast the body turns by either: the
// turn of each scan by the LiDAR against the turn of the legs over the same interval shifted by a lag, for a
// row of lags. The lag of least squares is the offset, by a parabola through the least three; its curvature
// and the residuals give the standard deviation. A scale between the two turns is estimated along.
//
// Its answer after a scan depends on the scans up to that one and on samples stamped before that scan's end
// alone, not on how far ahead of the scans the samples have arrived.
class ClockOffset {
 public:
  struct Estimate {
    double offset_s = 0;  // a legs' sample of instant t carries the stamp t + offset_s
    double sigma_s = 0;   // for turns that err independently; poses that do leave less, about a third
  };

  explicit ClockOffset(const ClockOffsetConfig& config);

  // Samples in order of time, as they are stamped.
  void addLegs(const BodyOdometry& sample);
  // Body at the end of each scan; registered: by the LiDAR, not only by prediction.
  void addScan(Time end, const SE3& T_odom_body, bool registered);

  // Nothing until the body has turned enough for a distinct answer.
  std::optional<Estimate> estimate() const;
  // The offset in force: zero until an estimate is trusted and says more than least_offset_s, since what is
  // right must stay as it is; later it follows an estimate that has moved by more than its error.
  Duration inForce() const { return in_force_; }

  // All but the configuration; see StateArchive.
  void visitState(auto& archive) {
    archive(lags_, lidar_lidar_, used_, legs_, newest_legs_, pending_, previous_scan_, in_force_);
  }

 private:
  struct Turn {
    Time time;
    double rad;  // since the first sample, about the body's z axis
  };
  struct Interval {
    Time begin, end;
    double rad;
  };
  // Sums over scans of the legs' turn at one lag.
  struct Lag {
    double legs_legs = 0, lidar_legs = 0;
  };
  std::vector<double> legsTurnsAt(Time time) const;
  std::optional<double> legsTurnAt(Time time) const;
  void use(const Interval& interval);
  double residual(size_t lag) const;
  void update();

  ClockOffsetConfig config_;
  std::vector<Lag> lags_;
  double lidar_lidar_ = 0;
  int64_t used_ = 0;
  std::deque<Turn> legs_;
  std::optional<SE3> newest_legs_;
  std::deque<Interval> pending_;
  std::optional<std::pair<Time, SE3>> previous_scan_;
  Duration in_force_;
};

}  // namespace sgraphs
