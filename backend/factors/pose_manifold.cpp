#include "backend/factors/pose_manifold.h"

namespace sgraphs {

SE3 PoseManifold::load(const double* x) {
  return {Eigen::Map<const Eigen::Quaterniond>(x + 3), Eigen::Map<const Eigen::Vector3d>(x)};
}

void PoseManifold::store(const SE3& T, double* x) {
  Eigen::Map<Eigen::Matrix<double, 7, 1>> out(x);
  out << T.translation, T.rotation.coeffs();
}

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  store(load(x) * se3Exp(Eigen::Map<const Vector6d>(delta)), x_plus_delta);
  return true;
}

// t + R rho, and q * (1, w/2) with the quaternion product q * (0, w) = (-v.w, q_w w + v x w), v the vector
// part.
bool PoseManifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> J(jacobian);
  const SE3 T = load(x);
  J.setZero();
  J.block<3, 3>(0, 0) = T.matrix3();
  J.block<3, 3>(3, 3) = 0.5 * (T.rotation.w() * Eigen::Matrix3d::Identity() + skew(T.rotation.vec()));
  J.block<1, 3>(6, 3) = -0.5 * T.rotation.vec().transpose();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Vector6d> out(y_minus_x);
  out = se3Log(load(x).inverse() * load(y));
  return true;
}

// R^T dt, and twice the vector part of conj(q) * dq.
PoseManifold::TangentFromAmbient PoseManifold::minusJacobian(const double* x) {
  const SE3 T = load(x);
  TangentFromAmbient J = TangentFromAmbient::Zero();
  J.block<3, 3>(0, 0) = T.matrix3().transpose();
  J.block<3, 3>(3, 3) = 2.0 * (T.rotation.w() * Eigen::Matrix3d::Identity() - skew(T.rotation.vec()));
  J.block<3, 1>(3, 6) = -2.0 * T.rotation.vec();
  return J;
}

bool PoseManifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<TangentFromAmbient> J(jacobian);
  J = minusJacobian(x);
  return true;
}

}  // namespace sgraphs
