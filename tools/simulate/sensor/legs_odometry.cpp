#include "tools/simulate/sensor/legs_odometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/simulate/sensor/random_stream.h"

namespace sgraphs::simulate {
namespace {

constexpr uint64_t kStream = 0x6c656773;  // apart from the streams of the LiDAR's firings

// R = Rz(yaw) Ry(pitch) Rx(roll).
struct Attitude {
  double roll = 0, pitch = 0, yaw = 0;

  explicit Attitude(const Eigen::Quaterniond& q) {
    const Eigen::Matrix3d R = q.toRotationMatrix();
    yaw = std::atan2(R(1, 0), R(0, 0));
    pitch = std::asin(std::clamp(-R(2, 0), -1.0, 1.0));
    roll = std::atan2(R(2, 1), R(2, 2));
  }
};

Eigen::Quaterniond rotationOf(double roll, double pitch, double yaw) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  return AngleAxisd(yaw, Vector3d::UnitZ()) * AngleAxisd(pitch, Vector3d::UnitY()) *
         AngleAxisd(roll, Vector3d::UnitX());
}

// Accumulates the errors of motion from one true pose to the next.
class DriftingState {
 public:
  DriftingState(const LegsOdometryModel& model, RandomStream& random) : model_(model), random_(random) {
    for (double* sign : {&scale_sign_, &turn_sign_, &yaw_sign_, &height_sign_})
      *sign = random_.uniform() < 0.5 ? -1.0 : 1.0;
  }

  void move(const SE3& before, const SE3& after) {
    const double yaw_before = Attitude(before.rotation).yaw;
    const double turned = std::remainder(Attitude(after.rotation).yaw - yaw_before, 2 * std::numbers::pi);
    const Eigen::Vector2d step = (after.translation - before.translation).head<2>();
    const double walked = step.norm();
    // The step in the heading of the body, scaled, with the feet's slip at turns.
    const double c = std::cos(yaw_before), s = std::sin(yaw_before);
    Eigen::Vector2d own(c * step.x() + s * step.y(), c * step.y() - s * step.x());
    own *= 1.0 + scale_sign_ * model_.scale;
    const double slip = model_.slip_m_per_rad * std::sqrt(std::abs(turned));
    own += slip * Eigen::Vector2d(random_.normal(), random_.normal());
    xy += Eigen::Rotation2Dd(yaw) * own;
    climbed += (1.0 + scale_sign_ * model_.scale) * (after.translation - before.translation).z();
    yaw += turned * (1.0 + turn_sign_ * model_.turn_scale) + yaw_sign_ * model_.yaw_bias_rad_per_m * walked +
           model_.yaw_walk_rad_per_sqrt_m * std::sqrt(walked) * random_.normal();
    height_error += height_sign_ * model_.height_bias_m_per_m * walked +
                    model_.height_walk_m_per_sqrt_m * std::sqrt(walked) * random_.normal();
    // First-order Gauss-Markov errors of the tilt.
    const double keep = std::exp(-1.0 / (model_.rate_hz * model_.tilt_time_s));
    const double fresh = model_.tilt_sigma_rad * std::sqrt(1.0 - keep * keep);
    roll_error = keep * roll_error + fresh * random_.normal();
    pitch_error = keep * pitch_error + fresh * random_.normal();
  }

  Eigen::Vector2d xy = Eigen::Vector2d::Zero();
  double climbed = 0, yaw = 0, height_error = 0, roll_error = 0, pitch_error = 0;

 private:
  const LegsOdometryModel& model_;
  RandomStream& random_;
  double scale_sign_ = 1, turn_sign_ = 1, yaw_sign_ = 1, height_sign_ = 1;
};

}  // namespace

std::vector<BodyOdometry> simulateLegsOdometry(const Trajectory& trajectory, const LegsOdometryModel& model,
                                               uint64_t seed) {
  RandomStream random(seed, kStream);
  DriftingState state(model, random);
  std::vector<BodyOdometry> samples;
  const Duration offset = Duration::fromSeconds(model.clock_offset_s);
  SE3 before = trajectory.feltPoseAt(trajectory.start());
  for (int64_t k = 0;; ++k) {
    const Time time = trajectory.start() + Duration::fromSeconds(static_cast<double>(k) / model.rate_hz);
    if (time > trajectory.end()) break;
    const SE3 truth = trajectory.feltPoseAt(time);
    double white = 0;
    if (k > 0) {
      state.move(before, truth);
      white = 1;
    }
    const Attitude attitude(truth.rotation);
    const auto shake = [&](double sigma) { return white * sigma * random.normal(); };
    const double turn = model.white_rotation_rad, shift = model.white_position_m;
    BodyOdometry sample{time + offset, {}};
    sample.T_odom_body.rotation =
        rotationOf(attitude.roll + state.roll_error + shake(turn),
                   attitude.pitch + state.pitch_error + shake(turn), state.yaw + shake(turn));
    sample.T_odom_body.translation = {state.xy.x() + shake(shift), state.xy.y() + shake(shift),
                                      state.climbed + state.height_error + shake(shift)};
    samples.push_back(sample);
    before = truth;
  }
  return samples;
}

}  // namespace sgraphs::simulate
