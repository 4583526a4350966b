#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sgraphs {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Rigid transform, named T_dst_src: p_dst = T_dst_src * p_src.
// Tangent vectors hold translation [m] first, then rotation [rad]; perturbations are on the right, in src:
// T * exp(delta). Covariances of poses are of that delta.
struct SE3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  SE3() = default;
  SE3(const Eigen::Quaterniond& q, const Eigen::Vector3d& t) : rotation(q), translation(t) {}

  SE3 operator*(const SE3& other) const {
    return {(rotation * other.rotation).normalized(), rotation * other.translation + translation};
  }
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return rotation * p + translation; }
  SE3 inverse() const {
    const Eigen::Quaterniond q = rotation.conjugate();
    return {q, -(q * translation)};
  }
  Eigen::Matrix3d matrix3() const { return rotation.toRotationMatrix(); }
  void visitState(auto& archive) { archive(rotation, translation); }
  bool isFinite() const { return rotation.coeffs().allFinite() && translation.allFinite(); }
};

Eigen::Matrix3d skew(const Eigen::Vector3d& v);

// Rotation vector [rad] to unit quaternion and back; the logarithm's angle lies in [0, pi].
Eigen::Quaterniond so3Exp(const Eigen::Vector3d& w);
Eigen::Vector3d so3Log(const Eigen::Quaterniond& q);

// J with so3Exp(w + dw) ~ so3Exp(w) * so3Exp(J dw) (Sola et al., "A micro Lie theory", eq. 143), and its
// inverse.
Eigen::Matrix3d so3RightJacobian(const Eigen::Vector3d& w);
Eigen::Matrix3d so3RightJacobianInverse(const Eigen::Vector3d& w);

// Exponential and logarithm of SE(3) (Sola et al., eqs. 172-174).
SE3 se3Exp(const Vector6d& xi);
Vector6d se3Log(const SE3& T);

// Ad with T * exp(xi) = exp(Ad xi) * T.
Matrix6d se3Adjoint(const SE3& T);

// J with exp(xi + dxi) ~ exp(xi) * exp(J dxi) (eqs. 179-180), and its inverse.
Matrix6d se3RightJacobian(const Vector6d& xi);
Matrix6d se3RightJacobianInverse(const Vector6d& xi);

// Constant-twist interpolation: a at s = 0, b at s = 1; other s extrapolate.
SE3 interpolate(const SE3& a, const SE3& b, double s);

// Covariance of T1 * T2 from independent covariances of T1 and T2, to first order.
Matrix6d composeCovariance(const Matrix6d& cov1, const SE3& T2, const Matrix6d& cov2);

}  // namespace sgraphs
