#include "perception/odometry/registration.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "perception/odometry/vote_balance.h"

namespace sgraphs {
namespace {

// Error of a cell's normal that averaging does not reduce.
constexpr double kNormalFloor_rad = 0.01;
// How many times stronger than feigned information a prior must be to hold against it.
constexpr double kOverFeigned = 10.0;
// A patch is an inlier within so many standard deviations of sensor and surface.
constexpr double kInlier = 3.0;
// A surface whose normal is steeper than 45 degrees is level: floor, ceiling, tread.
constexpr double kLevel = 0.7;
// The kernel's width on upright surfaces shrinks by this from iteration to iteration.
constexpr double kNarrowing = 0.7;
// No direction is claimed to be known worse than this [1/m^2, 1/rad^2]; it keeps inverses finite.
constexpr double kLeastInformation = 1.0;
constexpr size_t kBlock = 256;  // patches per partial sum; fixed, so that sums do not depend on the threads

using Upper = Eigen::Matrix<double, 6, 6>;

// Sums of one block of patches. Piece j adds to the knots j and j+1.
struct Sums {
  std::vector<Upper> diagonal, off_diagonal;  // off_diagonal[j]: knot j with knot j+1
  std::vector<Vector6d> gradient;
  std::vector<Vector6d> feigned, feigned_off;  // as diagonal and off_diagonal: what noise of the normals adds
  Upper rigid = Upper::Zero();
  double squares_m2 = 0;
  int matches = 0;

  explicit Sums(size_t knots)
      : diagonal(knots, Upper::Zero()),
        off_diagonal(knots, Upper::Zero()),
        gradient(knots, Vector6d::Zero()),
        feigned(knots, Vector6d::Zero()),
        feigned_off(knots, Vector6d::Zero()) {}

  void add(const Sums& other) {
    for (size_t j = 0; j < diagonal.size(); ++j) {
      diagonal[j] += other.diagonal[j];
      off_diagonal[j] += other.off_diagonal[j];
      gradient[j] += other.gradient[j];
      feigned[j] += other.feigned[j];
      feigned_off[j] += other.feigned_off[j];
    }
    rigid += other.rigid;
    squares_m2 += other.squares_m2;
    matches += other.matches;
  }
};

// Pieces of the motion, prepared once per iteration.
struct Pieces {
  explicit Pieces(const ScanMotion& motion) {
    for (size_t j = 0; j + 1 < motion.T_odom_body.size(); ++j)
      twist.push_back(se3Log(motion.T_odom_body[j].inverse() * motion.T_odom_body[j + 1]));
  }
  std::vector<Vector6d> twist;
};

SE3 poseAt(const ScanMotion::Place& place, const ScanMotion& motion, const Pieces& pieces) {
  return motion.T_odom_body[place.knot] * se3Exp(place.share * pieces.twist[place.knot]);
}

template <typename Work>
void forEach(size_t count, int threads, const Work& work) {
  if (threads > 1)
    tbb::parallel_for(size_t{0}, count, work);
  else
    for (size_t i = 0; i < count; ++i) work(i);
}

// What an iteration takes for a match, and how far off it may be.
struct Reach {
  double gate_m;
  double min_cos;
  double level_width, upright_width;  // of the kernel, in standard deviations
  bool final;                         // the kernel is as narrow as it gets

  Reach(const RegistrationConfig& config, int iteration)
      // Far matches help only while the guess is far off.
      : gate_m(iteration < 2 ? config.gate_m : 0.5 * config.gate_m),
        min_cos(std::cos(config.max_normal_angle_rad)),
        level_width(config.robust_width) {
    const double least = std::min(config.robust_width_upright, config.robust_width);
    upright_width = std::max(least, config.robust_width * std::pow(kNarrowing, iteration));
    final = upright_width == least;
  }

  double widthOn(const MapCell& cell) const {
    return std::abs(cell.normal.z()) > kLevel ? level_width : upright_width;
  }
};

// Residual and weight of one match: r = n . (T p - mu), its derivative by the right perturbation of T being
// [R^T n; p x R^T n] (translation, rotation).
void addPatch(const Surfel& s, double factor, const ScanMotion& motion, const Pieces& pieces,
              const SurfelMap& map, double sigma_floor_m, const Reach& reach, Sums& sums) {
  const auto [knot, share] = motion.placeOf(s.time_us);
  const SE3 T = poseAt({knot, share}, motion, pieces);
  const Eigen::Vector3d point = T * s.mean;
  const MapCell* cell = map.match(point, T.rotation * s.normal, reach.gate_m, reach.min_cos);
  if (!cell) return;
  const Eigen::Vector3d offset = point - cell->mean;
  const double r = cell->normal.dot(offset);
  // The plane is less known away from its mean.
  const double variance = s.variance_m2 + cell->variance_m2 +
                          cell->tilt_variance * (offset.squaredNorm() - r * r) +
                          sigma_floor_m * sigma_floor_m;
  const double width = reach.widthOn(*cell);
  const double weight = factor / (variance + r * r / (width * width));
  const Eigen::Vector3d m = T.rotation.conjugate() * cell->normal;
  Vector6d J;
  J << m, s.mean.cross(m);
  const Upper JJ = weight * J * J.transpose();
  const double a = 1.0 - share, b = share;
  sums.diagonal[knot] += a * a * JJ;
  sums.off_diagonal[knot] += a * b * JJ;
  sums.diagonal[knot + 1] += b * b * JJ;
  sums.gradient[knot] += (a * weight * r) * J;
  sums.gradient[knot + 1] += (b * weight * r) * J;
  sums.rigid += JJ;
  // J = [m; p x m] with m off by N(0, s^2) in the tangent plane: E[J J^T] grows by s^2 (I, |p|^2 I - p p^T).
  const double tilt2 = weight * (cell->tilt_variance + kNormalFloor_rad * kNormalFloor_rad);
  Vector6d feigned;
  feigned << Eigen::Vector3d::Constant(tilt2),
      tilt2 * (Eigen::Vector3d::Constant(s.mean.squaredNorm()) - s.mean.cwiseAbs2());
  sums.feigned[knot] += a * a * feigned;
  sums.feigned_off[knot] += a * b * feigned;
  sums.feigned[knot + 1] += b * b * feigned;
  if (r * r < kInlier * kInlier * variance) {
    sums.squares_m2 += r * r;
    ++sums.matches;
  }
}

// How much each patch counts, judged at the guess.
std::vector<double> balance(const std::vector<Surfel>& surfels, const ScanMotion& motion,
                            const SurfelMap& map, const RegistrationConfig& config, int threads) {
  const Pieces pieces(motion);
  const double min_cos = std::cos(config.max_normal_angle_rad);
  std::vector<PatchVote> votes(surfels.size());
  const auto find = [&](size_t i) {
    const Surfel& s = surfels[i];
    const SE3 T = poseAt(motion.placeOf(s.time_us), motion, pieces);
    const MapCell* cell = map.match(T * s.mean, T.rotation * s.normal, config.gate_m, min_cos);
    if (!cell) return;
    const double floor2 = config.sigma_floor_m * config.sigma_floor_m;
    votes[i] = {cell, 1.0 / (s.variance_m2 + cell->variance_m2 + floor2)};
  };
  forEach(surfels.size(), threads, find);
  return balanceVotes(votes, config.cell_sigma_m);
}

Sums sumPatches(const std::vector<Surfel>& surfels, const std::vector<double>& factors,
                const ScanMotion& motion, const SurfelMap& map, const RegistrationConfig& config,
                const Reach& reach, int threads) {
  const size_t knots = motion.T_odom_body.size();
  const size_t blocks = (surfels.size() + kBlock - 1) / kBlock;
  const Pieces pieces(motion);
  std::vector<Sums> partial(blocks, Sums(knots));
  const auto work = [&](size_t block) {
    const size_t end = std::min(surfels.size(), (block + 1) * kBlock);
    for (size_t i = block * kBlock; i < end; ++i)
      addPatch(surfels[i], factors[i], motion, pieces, map, config.sigma_floor_m, reach, partial[block]);
  };
  forEach(blocks, threads, work);
  Sums total(knots);
  for (const Sums& sums : partial) total.add(sums);
  return total;
}

// A measurement Z of the piece between knots j and j+1: e = Log(Z^-1 X_j^-1 X_j+1), to first order
// de = -Ad(X_j+1^-1 X_j) d_j + d_j+1 (the right Jacobian of a small e is the identity).
struct PieceError {
  Vector6d e;
  Matrix6d A;  // by knot j; by knot j+1 it is the identity
};

PieceError pieceError(const SE3& Xi, const SE3& Xj, const SE3& Z) {
  const SE3 between = Xi.inverse() * Xj;
  return {se3Log(Z.inverse() * between), -se3Adjoint(between.inverse())};
}

void addPriors(const MotionPrior& prior, const SE3& begin, const ScanMotion& motion, Eigen::MatrixXd& H,
               Eigen::VectorXd& g) {
  const std::vector<SE3>& X = motion.T_odom_body;
  const auto block = [&](size_t i, size_t j) {
    return H.block<6, 6>(static_cast<Eigen::Index>(6 * i), static_cast<Eigen::Index>(6 * j));
  };
  const auto segment = [&](size_t i) { return g.segment<6>(static_cast<Eigen::Index>(6 * i)); };
  block(0, 0) += prior.begin_information;
  segment(0) += prior.begin_information * se3Log(begin.inverse() * X[0]);
  for (size_t j = 0; j + 1 < X.size(); ++j) {
    SE3 Z;
    Matrix6d W;
    if (!prior.relative.empty()) {
      Z = prior.relative[j];
      W = prior.relative_information[j];
    } else {
      if (j == 0 && !prior.has_previous_twist) continue;
      // The motion of the piece before, held fixed within an iteration.
      Z = j == 0 ? se3Exp(motion.step().seconds() * prior.previous_twist) : X[j - 1].inverse() * X[j];
      W = prior.acceleration_information;
    }
    const PieceError error = pieceError(X[j], X[j + 1], Z);
    const Matrix6d WA = W * error.A;
    block(j, j) += error.A.transpose() * WA;
    block(j, j + 1) += error.A.transpose() * W;
    block(j + 1, j) += WA;
    block(j + 1, j + 1) += W;
    segment(j) += WA.transpose() * error.e;
    segment(j + 1) += W * error.e;
  }
}

void fillNormalEquations(const Sums& sums, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
  const size_t knots = sums.diagonal.size();
  for (size_t j = 0; j < knots; ++j) {
    const auto o = static_cast<Eigen::Index>(6 * j);
    H.block<6, 6>(o, o) = sums.diagonal[j];
    g.segment<6>(o) = sums.gradient[j];
    if (j + 1 < knots) {
      H.block<6, 6>(o, o + 6) = sums.off_diagonal[j];
      H.block<6, 6>(o + 6, o) = sums.off_diagonal[j].transpose();
    }
  }
}

// Keeps the height: r = z(X) - height, derivative by the right perturbation [third row of R, 0]. It must
// outweigh what the walls feign to know of the height (`feigned`, per m^2), and is nothing beside a floor or
// a ceiling in view. Beyond three standard deviations (stairs, a ramp) the pull grows no more (Huber).
void addHeight(const MotionPrior& prior, double feigned, const SE3& last, Eigen::MatrixXd& H,
               Eigen::VectorXd& g) {
  if (prior.height_information <= 0) return;
  const double information = prior.height_information + kOverFeigned * feigned;
  const double r = last.translation.z() - prior.height_m;
  const double weight = information * std::min(1.0, 3.0 / std::sqrt(r * r * information));
  const Eigen::Vector3d row = last.matrix3().row(2);
  const Eigen::Index o = H.rows() - 6;
  H.block<3, 3>(o, o) += weight * row * row.transpose();
  g.segment<3>(o) += weight * r * row;
}

// Nearest matrix whose eigenvalues are at least kLeastInformation.
Eigen::MatrixXd clamped(const Eigen::MatrixXd& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(kLeastInformation).asDiagonal() *
         eigen.eigenvectors().transpose();
}

// Information of one rigid pose, less what is feigned.
Matrix6d rigidInformation(const Sums& sums) {
  Matrix6d information = sums.rigid;
  for (size_t j = 0; j < sums.feigned.size(); ++j)
    information.diagonal() -= sums.feigned[j] + 2.0 * sums.feigned_off[j];
  return clamped(information);
}

// H without what is feigned.
Eigen::MatrixXd honestInformation(const Sums& sums, Eigen::MatrixXd H) {
  for (size_t j = 0; j < sums.feigned.size(); ++j) {
    const auto o = static_cast<Eigen::Index>(6 * j);
    H.diagonal().segment<6>(o) -= sums.feigned[j];
    if (j + 1 < sums.feigned.size()) {
      H.block<6, 6>(o, o + 6).diagonal() -= sums.feigned_off[j];
      H.block<6, 6>(o + 6, o).diagonal() -= sums.feigned_off[j];
    }
  }
  return clamped(H);
}

}  // namespace

ScanMotion::Place ScanMotion::placeOf(int32_t time_us) const {
  const auto pieces = static_cast<double>(T_odom_body.size() - 1);
  const double span = std::max<double>(1.0, static_cast<double>((end - begin).us));
  const double s = std::clamp((span + time_us) / span, 0.0, 1.0) * pieces;
  const auto knot = std::min(static_cast<size_t>(s), T_odom_body.size() - 2);
  return {knot, s - static_cast<double>(knot)};
}

SE3 ScanMotion::at(int32_t time_us) const {
  const auto [knot, share] = placeOf(time_us);
  return interpolate(T_odom_body[knot], T_odom_body[knot + 1], share);
}

Duration ScanMotion::step() const {
  return {(end - begin).us / static_cast<int64_t>(T_odom_body.size() - 1)};
}

RegistrationResult registerScan(const std::vector<Surfel>& surfels, const SurfelMap& map,
                                const MotionPrior& prior, const RegistrationConfig& config, int threads,
                                ScanMotion& motion) {
  RegistrationResult result;
  const size_t knots = motion.T_odom_body.size();
  const auto size = static_cast<Eigen::Index>(6 * knots);
  const SE3 begin = motion.T_odom_body.front();
  Eigen::MatrixXd H(size, size), honest(size, size);
  const std::vector<double> factors = balance(surfels, motion, map, config, threads);
  for (; result.iterations < config.max_iterations && !result.converged; ++result.iterations) {
    const Reach reach(config, result.iterations);
    const Sums sums = sumPatches(surfels, factors, motion, map, config, reach, threads);
    H.setZero();
    Eigen::VectorXd g = Eigen::VectorXd::Zero(size);
    fillNormalEquations(sums, H, g);
    addPriors(prior, begin, motion, H, g);
    addHeight(prior, sums.feigned.back().head<3>().maxCoeff(), motion.T_odom_body.back(), H, g);
    // Holds directions that neither LiDAR nor prior knows (standing in the void).
    H.diagonal().array() += 1e-6;
    const Eigen::VectorXd step = -H.ldlt().solve(g);
    for (size_t j = 0; j < knots; ++j)
      motion.T_odom_body[j] =
          motion.T_odom_body[j] * se3Exp(step.segment<6>(static_cast<Eigen::Index>(6 * j)));
    result.matches = sums.matches;
    result.residual_rms_m = sums.matches > 0 ? std::sqrt(sums.squares_m2 / sums.matches) : 0.0;
    const Vector6d last = step.tail<6>();
    result.converged = reach.final && last.head<3>().norm() < 1e-4 && last.tail<3>().norm() < 2e-5;
    if (result.converged || result.iterations + 1 == config.max_iterations) {
      result.lidar_information = rigidInformation(sums);
      honest = honestInformation(sums, H);
    }
  }
  result.inlier_share =
      surfels.empty() ? 0.0 : static_cast<double>(result.matches) / static_cast<double>(surfels.size());
  const Eigen::MatrixXd covariance = honest.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
  result.covariance =
      0.5 * (covariance.bottomRightCorner<6, 6>() + covariance.bottomRightCorner<6, 6>().transpose());
  return result;
}

RegistrationResult registerRigid(const std::vector<Surfel>& surfels, const SurfelMap& map,
                                 const Matrix6d& prior_information, const RegistrationConfig& config,
                                 int threads, SE3& T_target_source) {
  RegistrationResult result;
  const SE3 guess = T_target_source;
  const std::vector<double> factors =
      balance(surfels, {Time{0}, Time{1}, {guess, guess}}, map, config, threads);
  for (; result.iterations < config.max_iterations && !result.converged; ++result.iterations) {
    const Reach reach(config, result.iterations);
    ScanMotion still{Time{0}, Time{1}, {T_target_source, T_target_source}};
    const Sums sums = sumPatches(surfels, factors, still, map, config, reach, threads);
    const Matrix6d H = sums.rigid + prior_information;
    // Both knots hold the same pose, and their gradients add up to that of one rigid pose.
    const Vector6d g =
        sums.gradient[0] + sums.gradient[1] + prior_information * se3Log(guess.inverse() * T_target_source);
    const Vector6d step = -H.ldlt().solve(g);
    T_target_source = T_target_source * se3Exp(step);
    result.lidar_information = rigidInformation(sums);
    result.matches = sums.matches;
    result.residual_rms_m = sums.matches > 0 ? std::sqrt(sums.squares_m2 / sums.matches) : 0.0;
    result.converged = reach.final && step.head<3>().norm() < 1e-4 && step.tail<3>().norm() < 2e-5;
  }
  result.inlier_share =
      surfels.empty() ? 0.0 : static_cast<double>(result.matches) / static_cast<double>(surfels.size());
  result.covariance = (result.lidar_information + prior_information).ldlt().solve(Matrix6d::Identity());
  return result;
}

}  // namespace sgraphs
