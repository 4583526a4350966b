#include "perception/odometry/clock_offset.h"

#include <algorithm>
#include <cmath>

#include "common/config/config_io.h"
#include "common/geometry/se3.h"

namespace sgraphs {
namespace {

constexpr double kLagStep_s = 0.01;
// The legs' turn at an instant is a line fitted to the samples around it, so that its noise is alike between
// samples and at them: a lag must not seem better for lying between. Three samples of 50 Hz to either side.
constexpr double kKernel_s = 0.02;
constexpr double kReach_s = 0.06;
constexpr Duration kLongestInterval{300'000};
constexpr int64_t kFewestScans = 30;
constexpr double kLeastRefinement_s = 0.003;
// Of the two turns, at the offset.
constexpr double kLeastCorrelation = 0.8;

double turnBetween(const SE3& a, const SE3& b) {
  return so3Log(a.rotation.conjugate() * b.rotation).z();
}

}  // namespace

void ClockOffsetConfig::visit(ConfigVisitor& v) {
  v.field("estimate", estimate,
          "Estimate the legs' clock offset (mode fused) and correct their stamps by it");
  v.field("max_offset_s", max_offset_s, 0.05, 1.0, "Offsets beyond this are not looked for");
  v.field("trusted_sigma_s", trusted_sigma_s, 1e-4, 0.1, "An estimate is used when it is known this well");
  v.field("least_offset_s", least_offset_s, 0.0, 0.1,
          "Smaller offsets are left alone: half the time between samples of the legs");
}

ClockOffset::ClockOffset(const ClockOffsetConfig& config)
    : config_(config), lags_(static_cast<size_t>(2 * std::lround(config.max_offset_s / kLagStep_s) + 1)) {}

void ClockOffset::addLegs(const BodyOdometry& sample) {
  if (!config_.estimate) return;
  const double turned = newest_legs_ ? turnBetween(*newest_legs_, sample.T_odom_body) : 0.0;
  legs_.push_back({sample.time, legs_.empty() ? 0.0 : legs_.back().rad + turned});
  newest_legs_ = sample.T_odom_body;
}

void ClockOffset::addScan(Time end, const SE3& T_odom_body, bool registered) {
  if (!config_.estimate) return;
  if (registered) {
    if (previous_scan_ && end - previous_scan_->first <= kLongestInterval)
      pending_.push_back({previous_scan_->first, end, turnBetween(previous_scan_->second, T_odom_body)});
    previous_scan_.emplace(end, T_odom_body);
  } else {
    previous_scan_.reset();
  }
  // Samples up to end + the offset in force are there for certain; it may be negative.
  const Duration wait = Duration::fromSeconds(2 * config_.max_offset_s + kReach_s);
  bool news = false;
  while (!pending_.empty() && pending_.front().end + wait <= end) {
    use(pending_.front());
    pending_.pop_front();
    news = true;
  }
  const Time oldest = (pending_.empty() ? end : pending_.front().begin) -
                      Duration::fromSeconds(config_.max_offset_s + 2 * kReach_s);
  while (legs_.size() > 1 && legs_.front().time < oldest) legs_.pop_front();
  if (news) update();
}

std::optional<double> ClockOffset::legsTurnAt(Time time) const {
  const Duration reach = Duration::fromSeconds(kReach_s);
  auto sample = std::lower_bound(legs_.begin(), legs_.end(), time - reach,
                                 [](const Turn& t, Time at) { return t.time < at; });
  double w = 0, wx = 0, wxx = 0, wy = 0, wxy = 0;
  bool before = false, after = false;
  for (; sample != legs_.end() && sample->time <= time + reach; ++sample) {
    const double x = (sample->time - time).seconds();
    const double weight = std::exp(-0.5 * x * x / (kKernel_s * kKernel_s));
    before |= x <= 0;
    after |= x >= 0;
    w += weight;
    wx += weight * x;
    wxx += weight * x * x;
    wy += weight * sample->rad;
    wxy += weight * x * sample->rad;
  }
  const double determinant = w * wxx - wx * wx;
  if (!before || !after || determinant < 1e-9 * w * w) return std::nullopt;
  return (wxx * wy - wx * wxy) / determinant;
}

std::vector<double> ClockOffset::legsTurnsAt(Time time) const {
  std::vector<double> turns;
  const auto half = static_cast<int>(lags_.size() / 2);
  for (int j = -half; j <= half; ++j) {
    const std::optional<double> turn = legsTurnAt(time + Duration::fromSeconds(kLagStep_s * j));
    if (!turn) return {};
    turns.push_back(*turn);
  }
  return turns;
}

// A scan that the legs do not cover at every lag is left out: lags are compared over the same scans.
void ClockOffset::use(const Interval& interval) {
  const std::vector<double> begin = legsTurnsAt(interval.begin), end = legsTurnsAt(interval.end);
  if (begin.empty() || end.empty()) return;
  for (size_t j = 0; j < lags_.size(); ++j) {
    const double legs = end[j] - begin[j];
    lags_[j].legs_legs += legs * legs;
    lags_[j].lidar_legs += interval.rad * legs;
  }
  lidar_lidar_ += interval.rad * interval.rad;
  ++used_;
}

double ClockOffset::residual(size_t lag) const {
  const Lag& sums = lags_[lag];
  if (sums.lidar_legs <= 0) return lidar_lidar_;
  return lidar_lidar_ - sums.lidar_legs * sums.lidar_legs / sums.legs_legs;
}

std::optional<ClockOffset::Estimate> ClockOffset::estimate() const {
  if (used_ < kFewestScans) return std::nullopt;
  size_t best = 0;
  for (size_t j = 1; j < lags_.size(); ++j)
    if (residual(j) < residual(best)) best = j;
  if (best == 0 || best + 1 == lags_.size()) return std::nullopt;
  const double before = residual(best - 1), at = residual(best), after = residual(best + 1);
  const double bend = before - 2 * at + after;
  if (bend <= 0 || at > (1 - kLeastCorrelation * kLeastCorrelation) * lidar_lidar_) return std::nullopt;
  const double shift = 0.5 * (before - after) / bend;
  const size_t middle = lags_.size() / 2;  // the lag of zero
  const double curvature = bend / (2 * kLagStep_s * kLagStep_s);
  const double variance = at / static_cast<double>(used_ - 2);
  return Estimate{kLagStep_s * (static_cast<double>(best) - static_cast<double>(middle) + shift),
                  std::sqrt(variance / curvature)};
}

void ClockOffset::update() {
  const std::optional<Estimate> now = estimate();
  if (!now || now->sigma_s > config_.trusted_sigma_s) return;
  const double change_s = now->offset_s - in_force_.seconds();
  const double least_s = in_force_.us == 0 ? config_.least_offset_s : kLeastRefinement_s;
  if (std::abs(change_s) > std::max(least_s, 3 * now->sigma_s))
    in_force_ = Duration::fromSeconds(now->offset_s);
}

}  // namespace sgraphs
