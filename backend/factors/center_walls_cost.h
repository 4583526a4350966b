#pragma once

#include <ceres/cost_function.h>

#include <memory>

namespace sgraphs {

// The centre of a room or a storey halfway between two of its walls (the paper's room factor, for one pair).
//   r = (dist_a(p) - dist_b(p)) / sigma,  dist_i(p) = n_i.(p - anchor_i) + o_i,  p = (c_x, c_y, height)
// With both normals inward, p lies on the mid-plane. Nothing refers to the origin of the map, walls need not
// be parallel, and two pairs determine c: being free, it takes up what they disagree in, so that the factor
// by itself pulls at no wall. The height is where the walls were seen: walls are plumb only nearly.
// dr = ((n_a - n_b)_xy.dc + (p - anchor_a).dn_a + do_a - (p - anchor_b).dn_b - do_b) / sigma
class CenterWallsCost final : public ceres::CostFunction {
 public:
  // height_m in map. Throws std::logic_error unless it is finite and sigma_m positive and finite.
  static std::unique_ptr<CenterWallsCost> Create(double height_m, double sigma_m);

  // parameters: the centre in map (2); the two planes in map (PlaneManifold).
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  CenterWallsCost(double height_m, double sigma_m);

  double height_m_;
  double sqrt_information_;
};

}  // namespace sgraphs
