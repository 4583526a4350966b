#include "perception/odometry/odometry.h"

#include <tbb/task_arena.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "perception/odometry/floor_under_start.h"
#include "perception/odometry/keyframe_builder.h"
#include "perception/odometry/keyframe_registration.h"
#include "perception/odometry/legs_motion.h"
#include "perception/odometry/lift_watch.h"
#include "perception/odometry/registration.h"

namespace sgraphs {
namespace {

constexpr double kMerge_m = 0.08;  // a patch this close to a surface belongs to it
constexpr int kMinMatches = 60;    // fewer matches are no registration
constexpr double kMinShare = 0.08;
constexpr double kDegenerateSigma_m = 0.03;  // a direction that one scan knows worse than this is not seen
constexpr double kDegenerateSigma_rad = 0.01;
constexpr Duration kMaxGap{500000};  // a longer silence begins a new local motion
// After a silence this long, with no legs to bridge it, nothing is known of where the robot went meanwhile:
// no registration tells one wall of a building from the next.
constexpr Duration kLostGap{2000000};
constexpr double kWalk_mps = 1.0, kClimb_mps = 0.1, kTurn_radps = 0.8, kTilt_rad = 0.05;
constexpr Duration kMaxSweep{2000000};  // no LiDAR takes longer: such a scan's times are wrong
constexpr Duration kMinSweep{5000};     // a shorter one has no firing times: it was taken at one instant
constexpr Duration kFirstSweep{100000};
constexpr int64_t kPruneEvery = 50;  // scans
constexpr int kMaxFailures = 10;
// Share of the legs' covariance over a keyframe that remains between its pose and its own cloud.
constexpr double kBentByLegs = 0.05;

// A map of fewer scans may itself be bent: the first one was taken as if the robot stood.
constexpr int kSettled = 30;

Matrix6d diagonalInformation(double sigma_m, double sigma_rad) {
  Vector6d d;
  d << Eigen::Vector3d::Constant(1.0 / (sigma_m * sigma_m)),
      Eigen::Vector3d::Constant(1.0 / (sigma_rad * sigma_rad));
  return d.asDiagonal();
}

// Directions of motion that the matches alone do not determine: eigenvalues of the information of translation
// with rotation marginalised, and the reverse.
int countDegenerate(const Matrix6d& information) {
  const auto count = [&](int own, int other, double sigma) {
    const Eigen::Matrix3d A = information.block<3, 3>(own, own), B = information.block<3, 3>(own, other);
    const Eigen::Matrix3d C = information.block<3, 3>(other, other) + 1e-6 * Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d marginal = A - B * C.ldlt().solve(B.transpose());
    const Eigen::Vector3d values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(marginal).eigenvalues();
    return static_cast<int>((values.array() < 1.0 / (sigma * sigma)).count());
  };
  return count(0, 3, kDegenerateSigma_m) + count(3, 0, kDegenerateSigma_rad);
}

// Of the motion in a silence, in body.
Matrix6d unseenMotion(Duration gap) {
  const double s = gap.seconds(), walked_m = kWalk_mps * s, turned_rad = std::min(kTurn_radps * s, 3.0);
  Vector6d sigma;
  sigma << walked_m, walked_m, kClimb_mps * s, kTilt_rad, kTilt_rad, turned_rad;
  return sigma.cwiseAbs2().asDiagonal();
}

}  // namespace

class Odometry::Impl {
 public:
  Impl(const OdometryConfig& config, OdometryMode mode, const SE3& T_body_lidar)
      : config_(config),
        mode_(mode),
        T_body_lidar_(T_body_lidar),
        map_(config.registration.cell_m),
        builder_(config.keyframes, T_body_lidar),
        neighbours_(config.registration, config.covariance),
        lifts_(config.lifts),
        arena_(config.threads) {}

  std::optional<OdometryEstimate> step(const LidarScan& scan, std::span<const BodyOdometry> legs) {
    std::optional<OdometryEstimate> estimate;
    takeKeyframe();
    arena_.execute([&] { estimate = stepInArena(scan, legs); });
    return estimate;
  }

  std::optional<Keyframe> takeKeyframe() {
    if (!due_) return std::nullopt;
    std::optional<Keyframe> keyframe;
    arena_.execute([&] { keyframe = makeKeyframe(*due_); });
    due_.reset();
    return keyframe;
  }

  void visitState(StateArchive& archive) {
    if (due_) throw std::logic_error("the state of an odometry whose keyframe was not taken");
    archive(map_, builder_, neighbours_, lifts_, has_previous_, has_twist_, previous_pose_,
            legs_at_previous_end_, previous_end_, gap_, previous_twist_, height_m_, registered_covariance_,
            previous_registered_covariance_, keyframe_covariance_, edge_covariance_, T_odom_keyframe_,
            all_registered_, bridged_, new_map_, failures_, registered_in_a_row_, rides_, next_scan_,
            next_keyframe_, last_keyframe_scan_);
  }

 private:
  // A scan that became a keyframe which is not made yet.
  struct DueKeyframe {
    OdometryEstimate estimate;
    std::optional<UpDirection> up;
  };

  std::optional<OdometryEstimate> stepInArena(const LidarScan& scan, std::span<const BodyOdometry> legs) {
    // Twists over times that run backwards would throw the robot anywhere.
    if ((has_previous_ && scan.end <= previous_end_) || scan.end - scan.begin > kMaxSweep)
      return std::nullopt;
    const std::vector<int32_t> kept = prefilter(scan, T_body_lidar_, config_.prefilter);
    if (static_cast<int>(kept.size()) < config_.prefilter.min_points) return std::nullopt;
    const std::vector<Surfel> surfels =
        extractSurfels(scan, kept, T_body_lidar_, config_.surfels, config_.threads);
    const Time begin = beginOf(scan);
    std::optional<std::vector<SE3>> measured;
    if (mode_ != OdometryMode::kLidar) measured = measuredMotion(legs, begin, scan.end);

    OdometryEstimate e;
    const LiftWatch::Event ride =
        has_previous_ ? lifts_.step(scan, kept, T_body_lidar_, previous_pose_) : LiftWatch::Event::kNone;
    if (ride == LiftWatch::Event::kLetOut) goToAnotherFloor();
    ScanMotion motion = predict(begin, scan.end, legs, measured);
    estimate(surfels, measured, motion, e);
    remember(surfels, motion, e);
    legs_at_previous_end_ = legsPoseAt(legs, scan.end);
    builder_.add(scan, kept, surfels, motion);

    e.time = scan.end;
    e.scan = next_scan_++;
    e.T_odom_body = motion.T_odom_body.back();
    e.twist_body = previous_twist_;
    const bool lost_overlap = e.inlier_share >= 0 && e.inlier_share < config_.keyframes.min_inlier_share &&
                              e.scan - last_keyframe_scan_ >= 5;
    // What is seen before the ride does not go into the first keyframe after it.
    e.is_keyframe = builder_.due(e.T_odom_body) || lost_overlap || ride == LiftWatch::Event::kShutIn;
    if (e.is_keyframe) ++next_keyframe_;
    e.keyframe = KeyframeId{next_keyframe_ - 1};
    if (e.is_keyframe) due_ = DueKeyframe{e, upAt(e, surfels)};
    return e;
  }

  // After a ride in a lift the robot stands where it stood, on a floor whose height nothing tells: it is put
  // far from all that is known.
  void goToAnotherFloor() {
    const double rise_m = config_.lifts.storey_offset_m;
    previous_pose_.translation.z() += rise_m;
    height_m_ += rise_m;
    beginMapAnew();
    builder_.drop();
    const Eigen::Vector3d up = previous_pose_.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    const double aside_m = config_.lifts.vertical_sigma_rad * rise_m;
    // Should a loop bring the robot back, the rides share what is left over: unequally, or the floor between
    // would come to lie on the one where both began.
    const double sigma_m = rise_m * std::pow(3, rides_++ % 5);
    edge_covariance_.block<3, 3>(0, 0) += sigma_m * sigma_m * up * up.transpose();
    edge_covariance_.diagonal().head<3>().array() += aside_m * aside_m;
  }

  void beginMapAnew() {
    map_ = SurfelMap(config_.registration.cell_m);
    neighbours_.forget();
    new_map_ = true;
    registered_in_a_row_ = 0;
  }

  // The motion of a scan without firing times begins where the scan before ended.
  Time beginOf(const LidarScan& scan) const {
    if (!scan.deskewed && scan.end - scan.begin >= kMinSweep) return scan.begin;
    const bool follows = has_previous_ && scan.end - previous_end_ < kMaxGap;
    return follows ? previous_end_ : scan.end - kFirstSweep;
  }

  // The legs' motion over the scan, in pieces. The samples reach back to the scan's begin only; where its
  // motion begins with the scan before, the pose kept from there serves.
  std::optional<std::vector<SE3>> measuredMotion(std::span<const BodyOdometry> legs, Time begin,
                                                 Time end) const {
    const int segments = config_.registration.segments;
    const bool reach_back = legs.empty() || legs.front().time <= begin;
    if (reach_back || !has_previous_ || begin != previous_end_ || !legs_at_previous_end_)
      return legsMotion(legs, begin, end, segments);
    const std::optional<SE3> to = legsPoseAt(legs, end);
    if (!to) return std::nullopt;
    const Vector6d total = se3Log(legs_at_previous_end_->inverse() * *to);
    return std::vector<SE3>(static_cast<size_t>(segments), se3Exp(total / segments));
  }

  // Knots at the motion expected from the legs, else from the twist of the last scan.
  ScanMotion predict(Time scan_begin, Time scan_end, std::span<const BodyOdometry> legs,
                     const std::optional<std::vector<SE3>>& measured) {
    const int segments = config_.registration.segments;
    ScanMotion motion;
    motion.end = scan_end;
    motion.begin = scan_end - Duration{std::max<int64_t>((scan_end - scan_begin).us, 1000)};
    SE3 begin;
    if (!has_previous_) {
      const std::optional<SE3> start = measured ? legsPoseAt(legs, scan_begin) : std::nullopt;
      if (start) begin = *start;
    } else {
      // Scans follow each other without a gap, except where one was lost.
      const Duration gap = motion.begin - previous_end_;
      begin = gap < kMaxGap ? previous_pose_ * se3Exp(gap.seconds() * previous_twist_) : previous_pose_;
      bridged_ = false;
      if (gap.us > 1000 && mode_ != OdometryMode::kLidar) {
        const std::optional<SE3> to = legsPoseAt(legs, motion.begin);
        bridged_ = legs_at_previous_end_ && to;
        if (bridged_) begin = previous_pose_ * (legs_at_previous_end_->inverse() * *to);
      }
      gap_ = gap;
    }
    motion.T_odom_body.push_back(begin);
    const SE3 piece = se3Exp((motion.end - motion.begin).seconds() / segments * previous_twist_);
    for (int j = 0; j < segments; ++j)
      motion.T_odom_body.push_back(motion.T_odom_body.back() *
                                   (measured ? (*measured)[static_cast<size_t>(j)] : piece));
    return motion;
  }

  // What is known of the scan's begin: it is the end of the scan before, as well as the registration knew
  // that end, but for what a constant twist leaves out of a scan's motion. A begin that may leave it farther
  // lets scans bend: in a corridor the left wall is always seen at one time of the sweep and the right one at
  // another, so that the map agrees with any bend it was built with, until the robot turns round. Along a
  // corridor the end is hardly known; there the legs, if there are any, say the motion from it on.
  //
  // Nor may the begin be held tighter than it is known. What is seen at the share s of a sweep only (a floor
  // ahead that tells the pitch) puts the end at (seen - (1 - s) begin) / s: where the begin does not give
  // way, its error grows by (1 - s) / s from scan to scan, with alternating sign, until the robot nods by
  // degrees.
  Matrix6d beginInformation(bool has_legs) const {
    const RegistrationConfig& c = config_.registration;
    // After a silence the begin of the scan is a guess.
    const double gap_s = std::max(0.0, gap_.seconds() - 0.005);
    const Matrix6d loose =
        diagonalInformation(c.begin_sigma_m + 0.5 * gap_s, c.begin_sigma_rad + 0.5 * gap_s);
    if (gap_s > 0 || registered_in_a_row_ < kSettled) {
      if (has_legs) return loose;
      Matrix6d covariance = loose.inverse();
      covariance.bottomRightCorner<3, 3>() += previous_registered_covariance_.bottomRightCorner<3, 3>();
      return covariance.inverse();
    }
    Vector6d seam;
    seam << c.seam_sigma_m, c.seam_sigma_m, c.seam_vertical_sigma_m,
        Eigen::Vector3d::Constant(c.seam_sigma_rad);
    Matrix6d covariance = previous_registered_covariance_;
    covariance.diagonal() += seam.cwiseAbs2();
    const Matrix6d weak = has_legs ? loose : diagonalInformation(c.seam_weak_sigma_m, c.seam_weak_sigma_rad);
    return weak + covariance.inverse();
  }

  void estimate(const std::vector<Surfel>& surfels, const std::optional<std::vector<SE3>>& measured,
                ScanMotion& motion, OdometryEstimate& e) {
    const RegistrationConfig& c = config_.registration;
    const SE3 from = has_previous_ ? previous_pose_ : motion.T_odom_body.front();
    const SE3 moved = from.inverse() * motion.T_odom_body.back();
    e.covariance = legsCovariance(moved, config_.legs);
    e.extrapolated = has_previous_ && mode_ != OdometryMode::kLidar && !measured;
    registered_covariance_ = Matrix6d::Zero();
    const bool trusted_before = std::exchange(all_registered_, false);
    if (has_previous_ && gap_ >= kLostGap && !bridged_) {
      e.covariance = unseenMotion(gap_);
      e.extrapolated = true;
      beginMapAnew();
    }
    if (mode_ == OdometryMode::kEncoder || map_.empty()) return;

    MotionPrior prior;
    prior.begin_information = beginInformation(measured.has_value());
    if (measured) {
      for (const SE3& piece : *measured) {
        prior.relative.push_back(piece);
        prior.relative_information.push_back(legsCovariance(piece, config_.legs).inverse());
      }
    }
    const double dt = motion.step().seconds();
    prior.has_previous_twist = has_twist_;
    prior.previous_twist = previous_twist_;
    prior.acceleration_information =
        diagonalInformation(c.acceleration_sigma_mps2 * dt * dt, c.angular_acceleration_sigma_rps2 * dt * dt);
    const double vertical_m = c.vertical_acceleration_sigma_mps2 * dt * dt;
    prior.acceleration_information(2, 2) = 1.0 / (vertical_m * vertical_m);
    if (!measured) {
      // A body bobs, it does not rise: its vertical velocity is no guess for the next.
      prior.previous_twist[2] = 0;
      prior.height_m = height_m_;
      prior.height_information = 1.0 / (c.height_sigma_m * c.height_sigma_m);
    }
    const ScanMotion predicted = motion;
    const RegistrationResult result = registerScan(surfels, map_, prior, c, config_.threads, motion);
    e.inlier_share = result.inlier_share;
    e.residual_rms_m = result.residual_rms_m;
    e.num_degenerate = countDegenerate(result.lidar_information);
    if (result.matches < kMinMatches || result.inlier_share < kMinShare ||
        !motion.T_odom_body.back().isFinite()) {
      motion = predicted;
      e.extrapolated = true;
      ++failures_;
      registered_in_a_row_ = 0;
      return;
    }
    failures_ = 0;
    ++registered_in_a_row_;
    all_registered_ = trusted_before;
    registered_covariance_ = config_.covariance.scale * result.covariance;
    // Against the previous scan: both ends err.
    e.covariance = registered_covariance_ + previous_registered_covariance_;
  }

  // The scan enters the local map; the twist of its last piece predicts the next.
  void remember(const std::vector<Surfel>& surfels, const ScanMotion& motion, const OdometryEstimate& e) {
    // A scan that did not fit stays out, unless the robot has left the map for good.
    if (mode_ != OdometryMode::kEncoder && (failures_ == 0 || failures_ > kMaxFailures))
      for (const Surfel& s : surfels) map_.insert(s, motion.at(s.time_us), kMerge_m);
    if (next_scan_ % kPruneEvery == 0)
      map_.prune(motion.T_odom_body.back().translation, config_.registration.map_radius_m);
    const size_t n = motion.T_odom_body.size();
    const bool still_first = !has_previous_;
    if (!still_first || mode_ != OdometryMode::kLidar) {
      previous_twist_ =
          se3Log(motion.T_odom_body[n - 2].inverse() * motion.T_odom_body[n - 1]) / motion.step().seconds();
      has_twist_ = true;
    }
    const double z = motion.T_odom_body.back().translation.z();
    const double follow =
        std::min(1.0, (motion.end - motion.begin).seconds() / config_.registration.height_memory_s);
    height_m_ = has_previous_ ? height_m_ + follow * (z - height_m_) : z;
    edge_covariance_ = composeCovariance(edge_covariance_,
                                         previous_pose_.inverse() * motion.T_odom_body.back(), e.covariance);
    previous_registered_covariance_ = registered_covariance_;
    previous_pose_ = motion.T_odom_body.back();
    previous_end_ = motion.end;
    has_previous_ = true;
  }

  Keyframe makeKeyframe(const DueKeyframe& due) {
    const OdometryEstimate& e = due.estimate;
    std::vector<Surfel> surfels;
    const SE3 previous = T_odom_keyframe_;
    Keyframe keyframe = builder_.build(e.T_odom_body, surfels);
    keyframe.id = e.keyframe;
    keyframe.time = e.time;
    keyframe.scan = e.scan;
    if (due.up) {
      keyframe.up_body = due.up->up_body;
      keyframe.up_sigma_rad = due.up->sigma_rad;
    }
    if (keyframe.id.value > 0) {
      RelativePose r;
      r.from = KeyframeId{keyframe.id.value - 1};
      r.to = keyframe.id;
      r.T_from_to = previous.inverse() * e.T_odom_body;
      r.covariance = odometryEdgeCovariance(r.T_from_to);
      r.registered = mode_ != OdometryMode::kEncoder;
      keyframe.relative_poses.push_back(r);
    }
    // A cloud put together by the legs alone is bent by their drift.
    const bool by_legs = mode_ == OdometryMode::kEncoder;
    const Matrix6d anchor = by_legs ? Matrix6d(kBentByLegs * edge_covariance_) : registered_covariance_;
    for (RelativePose& r : neighbours_.step(keyframe.id, e.T_odom_body, surfels, anchor, config_.threads)) {
      // A scan is used once. Where the odometry has registered the same points against the local map, which
      // holds the neighbour's, this second look at them errs alike: it must not count as independent, and
      // only stands by for an odometry that has failed.
      if (!by_legs && all_registered_) r.covariance *= config_.covariance.neighbour_deflation;
      keyframe.relative_poses.push_back(r);
    }
    T_odom_keyframe_ = e.T_odom_body;
    keyframe_covariance_ = registered_covariance_;
    edge_covariance_ = Matrix6d::Zero();
    last_keyframe_scan_ = e.scan;
    new_map_ = false;
    all_registered_ = true;
    return keyframe;
  }

  // A registration against the local map errs anew at each end, it does not add up over the scans between;
  // what was only predicted or counted by the legs does.
  Matrix6d odometryEdgeCovariance(const SE3& T_from_to) const {
    const CovarianceConfig& c = config_.covariance;
    Matrix6d covariance = edge_covariance_;
    if (registered_covariance_.trace() > 0 && !new_map_)
      covariance = composeCovariance(keyframe_covariance_, T_from_to, registered_covariance_);
    covariance.diagonal().head<3>().array() += c.floor_m * c.floor_m;
    covariance.diagonal().tail<3>().array() += c.floor_rad * c.floor_rad;
    return covariance;
  }

  // At the end of the newest scan.
  std::optional<UpDirection> upAt(const OdometryEstimate& e, const std::vector<Surfel>& surfels) const {
    if (mode_ != OdometryMode::kLidar && legs_at_previous_end_)
      return UpDirection{legs_at_previous_end_->rotation.conjugate() * Eigen::Vector3d::UnitZ(),
                         config_.legs.up_sigma_rad};
    return e.keyframe.value == 0 ? floorUnderStart(surfels) : std::nullopt;
  }

  OdometryConfig config_;
  OdometryMode mode_;
  SE3 T_body_lidar_;
  SurfelMap map_;
  KeyframeBuilder builder_;
  KeyframeRegistration neighbours_;
  LiftWatch lifts_;
  tbb::task_arena arena_;

  bool has_previous_ = false, has_twist_ = false;
  SE3 previous_pose_;
  std::optional<SE3> legs_at_previous_end_;
  Time previous_end_;
  Duration gap_;
  Vector6d previous_twist_ = Vector6d::Zero();
  double height_m_ = 0;                                         // of the body in odom, smoothed
  Matrix6d registered_covariance_ = Matrix6d::Zero();           // of the newest scan; zero if not registered
  Matrix6d previous_registered_covariance_ = Matrix6d::Zero();  // of the scan before
  Matrix6d keyframe_covariance_ = Matrix6d::Zero();             // of the scan that became the last keyframe
  Matrix6d edge_covariance_ = Matrix6d::Zero();                 // summed up since the last keyframe
  SE3 T_odom_keyframe_;
  bool all_registered_ = true;  // every scan since the last keyframe found its place in the map
  bool bridged_ = false;        // legs measured the motion since the scan before, however long ago it was
  bool new_map_ = false;        // the local map began anew since the last keyframe
  int failures_ = 0;            // scans in a row that found no place in the map
  int registered_in_a_row_ = 0;
  int64_t rides_ = 0;
  int64_t next_scan_ = 0, next_keyframe_ = 0, last_keyframe_scan_ = 0;
  std::optional<DueKeyframe> due_;
};

Odometry::Odometry(const OdometryConfig& config, OdometryMode mode, const SE3& T_body_lidar)
    : impl_(std::make_unique<Impl>(config, mode, T_body_lidar)) {}
Odometry::~Odometry() = default;

void Odometry::visitState(StateArchive& archive) {
  impl_->visitState(archive);
}

std::optional<OdometryEstimate> Odometry::step(const LidarScan& scan,
                                               std::span<const BodyOdometry> body_odometry) {
  return impl_->step(scan, body_odometry);
}

std::optional<Keyframe> Odometry::takeKeyframe() {
  return impl_->takeKeyframe();
}

}  // namespace sgraphs
