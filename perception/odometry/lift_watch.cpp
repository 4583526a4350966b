#include "perception/odometry/lift_watch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace sgraphs {
namespace {

constexpr double kStanding_m = 0.3;  // a robot that turns on the spot moves less
constexpr float kChange_m = 0.3f;    // a direction in which more or less is seen than before
constexpr int kDoorSectors = 2;      // a door that opens shows in so many at once: 10 degrees
constexpr size_t kSeenSectors = 65;  // of 72: steel sends little back
constexpr Duration kBeforeClosing{500000};
constexpr size_t kStride =
    5;  // of the returns one in so many is looked at: of all rings, as 16 is no multiple

}  // namespace

LiftWatch::View LiftWatch::viewOf(const LidarScan& scan, const std::vector<int32_t>& kept,
                                  const SE3& T_odom_lidar) const {
  View view{};
  const Eigen::Matrix3f R = T_odom_lidar.matrix3().cast<float>();
  const Eigen::Vector2f from = (T_odom_lidar.translation - anchor_).head<2>().cast<float>();
  for (size_t i = 0; i < kept.size(); i += kStride) {
    const LidarPoint& point = scan.points[static_cast<size_t>(kept[i])];
    const Eigen::Vector2f p = (R * point.position_lidar).head<2>() + from;
    const float turn = std::atan2(p.y(), p.x()) / (2 * std::numbers::pi_v<float>)+0.5f;
    float& reach = view[std::min(static_cast<size_t>(turn * kSectors), kSectors - 1)];
    reach = std::max(reach, p.norm());
  }
  return view;
}

bool LiftWatch::encloses(const View& view) const {
  const auto far = std::count_if(view.begin(), view.end(), [&](float m) { return m > config_.car_reach_m; });
  const auto seen = std::count_if(view.begin(), view.end(), [](float m) { return m > 0; });
  double area_m2 = 0;
  for (const float m : view) area_m2 += std::numbers::pi / kSectors * m * m;
  return far < kDoorSectors && seen >= static_cast<std::ptrdiff_t>(kSeenSectors) &&
         area_m2 <= config_.car_area_m2;
}

void LiftWatch::close(Time time, const View& view) {
  closed_ = true;
  closed_since_ = time;
  view_m_ = view;
}

LiftWatch::Event LiftWatch::open() {
  closed_ = false;
  return std::exchange(shut_in_, false) ? Event::kLetOut : Event::kNone;
}

LiftWatch::Event LiftWatch::step(const LidarScan& scan, const std::vector<int32_t>& kept,
                                 const SE3& T_body_lidar, const SE3& T_odom_body) {
  if (!config_.enabled) return Event::kNone;
  if ((T_odom_body.translation - anchor_).norm() > kStanding_m) {
    anchor_ = T_odom_body.translation;
    still_since_ = scan.end;
    closed_ = shut_in_ = looked_ = false;
  }
  if (scan.end - still_since_ < kBeforeClosing) return Event::kNone;
  const View view = viewOf(scan, kept, T_odom_body * T_body_lidar);
  const bool came_in = !std::exchange(looked_, true);
  if (!encloses(view)) return open();
  int more = 0, less = 0;
  for (size_t i = 0; i < kSectors; ++i) {
    if (view[i] == 0 || view_m_[i] == 0) continue;
    more += view[i] > view_m_[i] + kChange_m;
    less += view[i] < view_m_[i] - kChange_m;
  }
  if (closed_ && more >= kDoorSectors) {
    const Event event = open();
    close(scan.end, view);
    return event;
  }
  // A robot that comes to stand in a closed space has walked in it: no door has closed behind it.
  if (!closed_ || less >= kDoorSectors) close(came_in ? still_since_ : scan.end, view);
  const bool door_closed = closed_since_ > still_since_;
  if (shut_in_ || !door_closed || (scan.end - closed_since_).seconds() < config_.closed_s)
    return Event::kNone;
  shut_in_ = true;
  return Event::kShutIn;
}

}  // namespace sgraphs
