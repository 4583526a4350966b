#pragma once

#include <ceres/cost_function.h>

#include <memory>

namespace sgraphs {

// The height of a storey is that of a level plane of it, where that was seen.
//   r = (z - e.(anchor - o n)) / sigma,  e: the map's z axis, which is up
// As SameHeightCost, the plane is asked where it is nearest to its anchor, not where its tilt would have to
// be extrapolated to. dr = (dz + o e.dn + e.n do) / sigma
class FloorHeightCost final : public ceres::CostFunction {
 public:
  // Throws std::logic_error unless sigma_m is positive and finite.
  static std::unique_ptr<FloorHeightCost> Create(double sigma_m);

  // parameters: the height in map (1); the plane in map (PlaneManifold).
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  explicit FloorHeightCost(double sigma_m);

  double sqrt_information_;
};

}  // namespace sgraphs
