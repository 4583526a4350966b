#include "backend/factors/room_shape_cost.h"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

#include "backend/factors/plane_manifold.h"

namespace sgraphs {

std::unique_ptr<RoomShapeCost> RoomShapeCost::Create(Kind kind, double sigma_rad) {
  if (!(sigma_rad > 0) || !std::isfinite(sigma_rad))
    throw std::logic_error("RoomShapeCost: sigma_rad must be positive and finite");
  return std::unique_ptr<RoomShapeCost>(new RoomShapeCost(kind, sigma_rad));
}

RoomShapeCost::RoomShapeCost(Kind kind, double sigma_rad) : kind_(kind), sqrt_information_(1.0 / sigma_rad) {
  set_num_residuals(1);
  *mutable_parameter_block_sizes() = {PlaneManifold::kAmbientSize, PlaneManifold::kAmbientSize};
}

bool RoomShapeCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Eigen::Vector3d a(parameters[0]), b(parameters[1]), up = Eigen::Vector3d::UnitZ();
  const bool parallel = kind_ == Kind::kParallel;
  residuals[0] = sqrt_information_ * (parallel ? up.dot(a.cross(b)) : a.dot(b));
  if (jacobians == nullptr) return true;

  const auto store = [&](const Eigen::Vector3d& by_normal, double* jacobian) {
    if (jacobian == nullptr) return;
    Eigen::Map<Eigen::Matrix<double, 1, 7>> J(jacobian);
    J.setZero();
    J.leftCols<3>() = sqrt_information_ * by_normal.transpose();
  };
  store(parallel ? b.cross(up) : b, jacobians[0]);
  store(parallel ? up.cross(a) : a, jacobians[1]);
  return true;
}

}  // namespace sgraphs
