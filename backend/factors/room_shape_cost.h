#pragma once

#include <ceres/cost_function.h>

#include <memory>

namespace sgraphs {

// Two walls of one room, seen from above; e is the map's z axis, which is up.
//   parallel: r = e.(n_a x n_b) / sigma, the sine of the angle between them, for facing and for equal normals
//   square:   r = n_a.n_b / sigma, the cosine of the angle between them
// Neither says anything about the walls' places, and what is out of plumb counts in second order only.
//   d parallel = e.(dn_a x n_b + n_a x dn_b) / sigma = ((n_b x e).dn_a + (e x n_a).dn_b) / sigma
class RoomShapeCost final : public ceres::CostFunction {
 public:
  enum class Kind { kParallel, kSquare };

  // Throws std::logic_error unless sigma_rad is positive and finite.
  static std::unique_ptr<RoomShapeCost> Create(Kind kind, double sigma_rad);

  // parameters: the two planes in map (PlaneManifold).
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  RoomShapeCost(Kind kind, double sigma_rad);

  Kind kind_;
  double sqrt_information_;
};

}  // namespace sgraphs
