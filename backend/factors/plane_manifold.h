#pragma once

#include <ceres/manifold.h>

#include "backend/factors/unit_vector_manifold.h"

namespace sgraphs {

// Planes: [nx ny nz d] with n.(p - anchor) + d = 0, the anchor a constant of the state's owner. The tangent
// is (tilt [rad], tilt [rad], offset [m]) with the tilts along tangentBasis(n), so that tilt and offset are
// coupled as little as the anchor is close to where the plane was seen.
class PlaneManifold final : public ceres::Manifold {
 public:
  static constexpr int kAmbientSize = 4;
  static constexpr int kTangentSize = 3;

  int AmbientSize() const override { return kAmbientSize; }
  int TangentSize() const override { return kTangentSize; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

}  // namespace sgraphs
