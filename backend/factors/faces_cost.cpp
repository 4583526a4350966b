#include "backend/factors/faces_cost.h"

#include <cmath>
#include <stdexcept>

#include "backend/factors/lateral_part.h"
#include "backend/factors/plane_manifold.h"

namespace sgraphs {

std::unique_ptr<FacesCost> FacesCost::Create(double sigma_rad) {
  if (!(sigma_rad > 0) || !std::isfinite(sigma_rad))
    throw std::logic_error("FacesCost: sigma_rad must be positive and finite");
  return std::unique_ptr<FacesCost>(new FacesCost(sigma_rad));
}

FacesCost::FacesCost(double sigma_rad) : sqrt_information_(1.0 / sigma_rad) {
  set_num_residuals(2);
  *mutable_parameter_block_sizes() = {PlaneManifold::kAmbientSize, PlaneManifold::kAmbientSize};
}

bool FacesCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Eigen::Vector3d normal_a(parameters[0]), normal_b(parameters[1]);
  const LateralPart lateral(normal_a, normal_b);
  Eigen::Map<Eigen::Vector2d> r(residuals);
  r = sqrt_information_ * lateral.value;
  if (jacobians == nullptr) return true;

  for (int i = 0; i < 2; ++i) {
    if (jacobians[i] == nullptr) continue;
    Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> J(jacobians[i]);
    J.setZero();
    J.leftCols<3>() = sqrt_information_ * (i == 0 ? lateral.by_n : lateral.by_w);
  }
  return true;
}

}  // namespace sgraphs
