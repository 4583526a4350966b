#include "common/geometry/se3.h"

#include <cmath>

namespace sgraphs {
namespace {

constexpr double kSmallAngle = 1e-5;

// The block Q of the left Jacobian of SE(3) (Barfoot, "State Estimation for Robotics", eq. 7.86b; Sola eq.
// 180).
Eigen::Matrix3d leftJacobianQ(const Eigen::Vector3d& rho, const Eigen::Vector3d& w) {
  const Eigen::Matrix3d R = skew(rho), W = skew(w);
  const double th2 = w.squaredNorm(), th = std::sqrt(th2);
  double a = 1.0 / 6.0 - th2 / 120.0 + th2 * th2 / 5040.0;
  double b = 1.0 / 24.0 - th2 / 720.0 + th2 * th2 / 40320.0;
  double c = 1.0 / 120.0 - th2 / 2520.0 + th2 * th2 / 120960.0;
  // The closed forms cancel for small angles; at 0.05 rad both are good to nine digits.
  if (th > 0.05) {
    a = (th - std::sin(th)) / (th2 * th);
    b = (th2 / 2.0 + std::cos(th) - 1.0) / (th2 * th2);
    c = (2.0 * th - 3.0 * std::sin(th) + th * std::cos(th)) / (2.0 * th2 * th2 * th);
  }
  return 0.5 * R + a * (W * R + R * W + W * R * W) + b * (W * W * R + R * W * W - 3.0 * W * R * W) +
         c * (W * R * W * W + W * W * R * W);
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Quaterniond so3Exp(const Eigen::Vector3d& w) {
  const double th2 = w.squaredNorm(), th = std::sqrt(th2);
  const double k = th < kSmallAngle ? 0.5 - th2 / 48.0 : std::sin(0.5 * th) / th;
  return Eigen::Quaterniond(std::cos(0.5 * th), k * w.x(), k * w.y(), k * w.z());
}

Eigen::Vector3d so3Log(const Eigen::Quaterniond& q_in) {
  const Eigen::Quaterniond q =
      q_in.w() < 0 ? Eigen::Quaterniond(-q_in.w(), -q_in.x(), -q_in.y(), -q_in.z()) : q_in;
  const double n = q.vec().norm();
  const double k = n < kSmallAngle ? 2.0 / q.w() : 2.0 * std::atan2(n, q.w()) / n;
  return k * q.vec();
}

Eigen::Matrix3d so3RightJacobian(const Eigen::Vector3d& w) {
  const double th2 = w.squaredNorm(), th = std::sqrt(th2);
  const Eigen::Matrix3d W = skew(w);
  // 1 - cos cancels for small angles, the half angle's sine does not.
  const double sin_half = std::sin(0.5 * th);
  const double a = th < kSmallAngle ? 0.5 - th2 / 24.0 : 2.0 * sin_half * sin_half / th2;
  const double b = th < kSmallAngle ? 1.0 / 6.0 - th2 / 120.0 : (th - std::sin(th)) / (th2 * th);
  return Eigen::Matrix3d::Identity() - a * W + b * W * W;
}

Eigen::Matrix3d so3RightJacobianInverse(const Eigen::Vector3d& w) {
  const double th2 = w.squaredNorm(), th = std::sqrt(th2);
  const Eigen::Matrix3d W = skew(w);
  const double c =
      th < 1e-4 ? 1.0 / 12.0 + th2 / 720.0 : 1.0 / th2 - (1.0 + std::cos(th)) / (2.0 * th * std::sin(th));
  return Eigen::Matrix3d::Identity() + 0.5 * W + c * W * W;
}

SE3 se3Exp(const Vector6d& xi) {
  const Eigen::Vector3d w = xi.tail<3>();
  // The left Jacobian of SO(3) is the right one of the opposite rotation.
  return {so3Exp(w), so3RightJacobian(-w) * xi.head<3>()};
}

Vector6d se3Log(const SE3& T) {
  const Eigen::Vector3d w = so3Log(T.rotation);
  Vector6d xi;
  xi << so3RightJacobianInverse(-w) * T.translation, w;
  return xi;
}

Matrix6d se3Adjoint(const SE3& T) {
  const Eigen::Matrix3d R = T.matrix3();
  Matrix6d Ad = Matrix6d::Zero();
  Ad.topLeftCorner<3, 3>() = R;
  Ad.bottomRightCorner<3, 3>() = R;
  Ad.topRightCorner<3, 3>() = skew(T.translation) * R;
  return Ad;
}

Matrix6d se3RightJacobian(const Vector6d& xi) {
  const Eigen::Vector3d rho = xi.head<3>(), w = xi.tail<3>();
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = so3RightJacobian(w);
  J.topRightCorner<3, 3>() = leftJacobianQ(-rho, -w);
  return J;
}

Matrix6d se3RightJacobianInverse(const Vector6d& xi) {
  const Eigen::Vector3d rho = xi.head<3>(), w = xi.tail<3>();
  const Eigen::Matrix3d Jinv = so3RightJacobianInverse(w);
  Matrix6d out = Matrix6d::Zero();
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = Jinv;
  out.topRightCorner<3, 3>() = -Jinv * leftJacobianQ(-rho, -w) * Jinv;
  return out;
}

SE3 interpolate(const SE3& a, const SE3& b, double s) {
  return a * se3Exp(s * se3Log(a.inverse() * b));
}

Matrix6d composeCovariance(const Matrix6d& cov1, const SE3& T2, const Matrix6d& cov2) {
  // T1 exp(d1) T2 exp(d2) = T1 T2 exp(Ad(T2^-1) d1) exp(d2).
  const Matrix6d Ad = se3Adjoint(T2.inverse());
  return Ad * cov1 * Ad.transpose() + cov2;
}

}  // namespace sgraphs
