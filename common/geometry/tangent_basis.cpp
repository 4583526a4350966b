#include "common/geometry/tangent_basis.h"

#include <Eigen/Geometry>
#include <cmath>

namespace sgraphs {

TangentBasis tangentBasis(const Eigen::Vector3d& n) {
  const double s = std::copysign(1.0, n.z());
  const double a = -1.0 / (s + n.z());
  const double b = n.x() * n.y() * a;
  TangentBasis B;
  B.col(0) << 1.0 + s * n.x() * n.x() * a, s * b, -s * n.x();
  B.col(1) << b, s + n.y() * n.y() * a, -n.y();
  return B;
}

Eigen::Matrix2d tangentTurn(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Matrix3d R = Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
  return tangentBasis(to).transpose() * R * tangentBasis(from);
}

}  // namespace sgraphs
