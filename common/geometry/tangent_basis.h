#pragma once

#include <Eigen/Core>

namespace sgraphs {

using TangentBasis = Eigen::Matrix<double, 3, 2>;

// Two orthonormal columns perpendicular to the unit vector n, right-handed with it (b1 x b2 = n): a function
// of n alone, defined everywhere, discontinuous only where n.z changes sign (Duff et al., "Building an
// orthonormal basis, revisited", 2017).
TangentBasis tangentBasis(const Eigen::Vector3d& n);

// Takes coordinates across `from` to those across `to`, carried along by the smallest turn between the two
// unit vectors: a rotation, also where the basis flips between them.
Eigen::Matrix2d tangentTurn(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace sgraphs
