#include "backend/factors/plane_up_cost.h"

#include <cmath>
#include <stdexcept>

#include "backend/factors/lateral_part.h"
#include "backend/factors/plane_manifold.h"

namespace sgraphs {
namespace {

// Rows by the plane's ambient coordinates and by up's: the offset and the anchor have no part in it.
template <int kRows>
void storeJacobians(const Eigen::Matrix<double, kRows, 3>& by_normal,
                    const Eigen::Matrix<double, kRows, 3>& by_up, double** jacobians) {
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, kRows, 7, Eigen::RowMajor>> J(jacobians[0]);
    J.setZero();
    J.template leftCols<3>() = by_normal;
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, kRows, 3, Eigen::RowMajor>> J(jacobians[1]);
    J = by_up;
  }
}

}  // namespace

std::unique_ptr<PlaneUpCost> PlaneUpCost::Create(Kind kind, double sigma_rad) {
  if (!(sigma_rad > 0) || !std::isfinite(sigma_rad))
    throw std::logic_error("PlaneUpCost: sigma_rad must be positive and finite");
  return std::unique_ptr<PlaneUpCost>(new PlaneUpCost(kind, sigma_rad));
}

PlaneUpCost::PlaneUpCost(Kind kind, double sigma_rad) : kind_(kind), sqrt_information_(1.0 / sigma_rad) {
  set_num_residuals(kind == Kind::kLevel ? 2 : 1);
  *mutable_parameter_block_sizes() = {PlaneManifold::kAmbientSize, UnitVectorManifold::kAmbientSize};
}

bool PlaneUpCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Eigen::Vector3d normal(parameters[0]), up(parameters[1]);
  if (kind_ == Kind::kPlumb) {
    residuals[0] = sqrt_information_ * normal.dot(up);
    if (jacobians != nullptr)
      storeJacobians<1>(sqrt_information_ * up.transpose(), sqrt_information_ * normal.transpose(),
                        jacobians);
    return true;
  }
  const LateralPart lateral(normal, up);
  Eigen::Map<Eigen::Vector2d> r(residuals);
  r = sqrt_information_ * lateral.value;
  if (jacobians != nullptr)
    storeJacobians<2>(sqrt_information_ * lateral.by_n, sqrt_information_ * lateral.by_w, jacobians);
  return true;
}

}  // namespace sgraphs
