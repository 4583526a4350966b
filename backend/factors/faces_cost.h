#pragma once

#include <ceres/cost_function.h>

#include <memory>

namespace sgraphs {

// Two faces of one wall: antiparallel normals, the thickness free.
//   r = B(n_a)^T (n_a + n_b) / sigma = B(n_a)^T n_b / sigma
// |r| is the sine of the angle between n_b and -n_a (LateralPart). It is as small for equal normals: who
// pairs the faces sees to it that they are opposite.
class FacesCost final : public ceres::CostFunction {
 public:
  // Throws std::logic_error unless sigma_rad is positive and finite.
  static std::unique_ptr<FacesCost> Create(double sigma_rad);

  // parameters: the two planes in map (PlaneManifold).
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  explicit FacesCost(double sigma_rad);

  double sqrt_information_;
};

}  // namespace sgraphs
