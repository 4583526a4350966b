#pragma once

#include <ceres/cost_function.h>

#include <memory>

namespace sgraphs {

// A plane against the map's direction u = up.
//   level (floors, ceilings): r = B(n)^T u / sigma, 2 residuals; |r| is the sine of the angle between n and
//     the vertical, for normals up and down alike (LateralPart)
//   plumb (walls): r = n.u / sigma, the sine of the angle out of plumb
// Neither says anything about the offset. Both are monotonic up to 90 degrees off.
class PlaneUpCost final : public ceres::CostFunction {
 public:
  enum class Kind { kLevel, kPlumb };

  // Throws std::logic_error unless sigma_rad is positive and finite.
  static std::unique_ptr<PlaneUpCost> Create(Kind kind, double sigma_rad);

  // parameters: the plane in map (PlaneManifold); up in map (UnitVectorManifold).
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  PlaneUpCost(Kind kind, double sigma_rad);

  Kind kind_;
  double sqrt_information_;
};

}  // namespace sgraphs
