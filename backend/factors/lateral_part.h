#pragma once

#include "common/geometry/tangent_basis.h"

namespace sgraphs {

// The part of a direction w across another direction n: B(n)^T w, B = tangentBasis. Its length is the sine
// of the angle between them in every map frame; only its two coordinates turn with the basis.
// When n moves by dn (along the sphere), the basis turns by
//   W = n x dn - n p.(n x dn) / (1 + p.n),   p = +-e_z on the side of n,
// because B(n) is a fixed basis carried from p to n by the shortest rotation: the quaternion (1 + p.n, p x n)
// up to scale, and W = 2 Im(dQ Q*) / |Q|^2. Hence d(b_i.w) = (W x b_i).w = (b_i x w).W.
struct LateralPart {
  Eigen::Vector2d value;
  Eigen::Matrix<double, 2, 3> by_n;  // for dn along the sphere
  Eigen::Matrix<double, 2, 3> by_w;

  LateralPart(const Eigen::Vector3d& n, const Eigen::Vector3d& w);
};

}  // namespace sgraphs
