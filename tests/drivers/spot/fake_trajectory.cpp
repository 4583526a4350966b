#include "tests/drivers/spot/fake_trajectory.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "common/base/error.h"
#include "common/bus/channels.h"
#include "common/bus/log_file.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs::test {

FakeTrajectory::FakeTrajectory(std::vector<StampedPose> poses, Time start)
    : poses_(std::move(poses)), start_(start) {
  if (poses_.size() < 2) throw Error("a walk needs two poses at least");
}

FakeMotion FakeTrajectory::at(Time host) const {
  const Time now = poses_.front().time + (host - start_);
  if (now <= poses_.front().time) return {poses_.front().pose};
  if (now >= poses_.back().time) return {poses_.back().pose};
  const auto next = std::upper_bound(poses_.begin(), poses_.end(), now,
                                     [](Time time, const StampedPose& pose) { return time < pose.time; });
  const StampedPose &a = *std::prev(next), &b = *next;
  const double dt_s = (b.time - a.time).seconds();
  FakeMotion motion{interpolate(a.pose, b.pose, (now - a.time).seconds() / dt_s)};
  const Vector6d twist_body = se3Log(a.pose.inverse() * b.pose) / dt_s;
  motion.linear_odom_mps = motion.T_odom_body.rotation * twist_body.head<3>();
  motion.angular_odom_radps = motion.T_odom_body.rotation * twist_body.tail<3>();
  return motion;
}

std::vector<StampedPose> readOdometryOfLog(const std::string& path) {
  std::vector<StampedPose> poses;
  LogReader log(path);
  while (const std::optional<LogEvent> event = log.next()) {
    spot_odometry_t message{};
    if (event->channel != channels::kSpotOdometry.name || !decode(event->bytes, message)) continue;
    const std::optional<BodyOdometry> sample = fromMessage(message);
    if (sample && (poses.empty() || sample->time > poses.back().time))
      poses.push_back({sample->time, sample->T_odom_body});
  }
  if (poses.empty()) throw Error(path + ": no SPOT_ODOMETRY in this log");
  return poses;
}

}  // namespace sgraphs::test
