#pragma once

#include <ceres/cost_function.h>

#include <memory>

namespace sgraphs {

// Two horizontals (floors, or ceilings) at one height along u = up.
//   r = u.(h_a - h_b) / sigma,  h = anchor - offset n: the point of each plane nearest to its own anchor
// Each plane is asked for its height where it was seen, not where its tilt would have to be extrapolated
// to; between places far apart the direction u matters, and has its share in the residual.
// With e = h_a - h_b: dr = u.(-o_a dn_a - n_a do_a + o_b dn_b + n_b do_b) + e.du, all by sigma.
class SameHeightCost final : public ceres::CostFunction {
 public:
  // Throws std::logic_error unless sigma_m is positive and finite.
  static std::unique_ptr<SameHeightCost> Create(double sigma_m);

  // parameters: the two planes in map (PlaneManifold); up in map (UnitVectorManifold).
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  explicit SameHeightCost(double sigma_m);

  double sqrt_information_;
};

}  // namespace sgraphs
