#include "backend/factors/pose_plane_cost.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <stdexcept>

#include "backend/factors/plane_manifold.h"
#include "backend/factors/pose_manifold.h"

namespace sgraphs {

std::unique_ptr<PosePlaneCost> PosePlaneCost::Create(const PlaneObservation& observation) {
  const Eigen::LLT<Eigen::Matrix3d> llt(observation.covariance);
  if (!(std::abs(observation.normal_body.norm() - 1.0) < 1e-6) || !observation.centroid_body.allFinite() ||
      !observation.covariance.allFinite() || llt.info() != Eigen::Success)
    throw std::logic_error(
        "PosePlaneCost: normal not a unit vector, centroid not finite or covariance not positive definite");
  const Eigen::Matrix3d sqrt_information = llt.matrixL().solve(Eigen::Matrix3d::Identity());
  return std::unique_ptr<PosePlaneCost>(new PosePlaneCost(observation, sqrt_information));
}

PosePlaneCost::PosePlaneCost(const PlaneObservation& observation, const Eigen::Matrix3d& sqrt_information)
    : basis_(tangentBasis(observation.normal_body).transpose()),
      centroid_body_(observation.centroid_body),
      sqrt_information_(sqrt_information) {
  set_num_residuals(3);
  *mutable_parameter_block_sizes() = {PoseManifold::kAmbientSize, PlaneManifold::kAmbientSize};
}

bool PosePlaneCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const SE3 T_map_body = PoseManifold::load(parameters[0]);
  const PlaneState plane = PlaneManifold::load(parameters[1]);
  const Eigen::Matrix3d R_body_map = T_map_body.matrix3().transpose();
  const Eigen::Vector3d normal_body = R_body_map * plane.normal;
  const Eigen::Vector3d centroid_map = T_map_body * centroid_body_;
  Eigen::Vector3d error;
  error << basis_ * normal_body, -plane.distance(centroid_map);
  Eigen::Map<Eigen::Vector3d> r(residuals);
  r.noalias() = sqrt_information_ * error;
  if (jacobians == nullptr) return true;

  if (jacobians[0] != nullptr) {
    Eigen::Matrix<double, 3, 6> J;
    J.topLeftCorner<2, 3>().setZero();
    J.topRightCorner<2, 3>() = basis_ * skew(normal_body);
    J.bottomLeftCorner<1, 3>() = -normal_body.transpose();
    J.bottomRightCorner<1, 3>() = -centroid_body_.cross(normal_body).transpose();
    Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>> ambient(jacobians[0]);
    ambient = (sqrt_information_ * J) * PoseManifold::minusJacobian(parameters[0]);
  }
  if (jacobians[1] != nullptr) {
    // The anchor's columns stay zero: the manifold never moves it.
    Eigen::Matrix<double, 3, 7> J = Eigen::Matrix<double, 3, 7>::Zero();
    J.topLeftCorner<2, 3>() = basis_ * R_body_map;
    J.bottomLeftCorner<1, 3>() = (plane.anchor - centroid_map).transpose();
    J(2, 3) = -1.0;
    Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>> ambient(jacobians[1]);
    ambient = sqrt_information_ * J;
  }
  return true;
}

}  // namespace sgraphs
