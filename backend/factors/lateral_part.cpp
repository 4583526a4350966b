#include "backend/factors/lateral_part.h"

#include <cmath>

#include "common/geometry/se3.h"

namespace sgraphs {

LateralPart::LateralPart(const Eigen::Vector3d& n, const Eigen::Vector3d& w) {
  const TangentBasis B = tangentBasis(n);
  const Eigen::Vector3d pole(0, 0, std::copysign(1.0, n.z()));  // the side as tangentBasis takes it
  const Eigen::Matrix3d across = skew(n);
  const Eigen::RowVector3d twist = pole.transpose() * across / (1.0 + pole.dot(n));
  const Eigen::Matrix3d turn = across - n * twist;
  by_w = B.transpose();
  value = by_w * w;
  by_n.row(0) = B.col(0).cross(w).transpose() * turn;
  by_n.row(1) = B.col(1).cross(w).transpose() * turn;
}

}  // namespace sgraphs
