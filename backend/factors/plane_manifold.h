#pragma once

#include <ceres/manifold.h>

#include "backend/factors/plane_state.h"
#include "backend/factors/unit_vector_manifold.h"

namespace sgraphs {

// Planes as seven doubles, [nx ny nz offset ax ay az], see PlaneState. The tangent is (tilt [rad], tilt
// [rad], offset [m]) with the tilts along tangentBasis(n); the anchor never moves. Being part of the state,
// it goes along when a factor is bound to another plane.
class PlaneManifold final : public ceres::Manifold {
 public:
  static constexpr int kAmbientSize = 7;
  static constexpr int kTangentSize = 3;

  int AmbientSize() const override { return kAmbientSize; }
  int TangentSize() const override { return kTangentSize; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

  static PlaneState load(const double* x);
  static void store(const PlaneState& plane, double* x);
};

}  // namespace sgraphs
