#include "backend/planes/shared_information.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace sgraphs {

// covariance = C C^T. In the coordinates y = C^-1 x the measurement's information is the identity and that of
// the planes C^T I C = Q diag(m) Q^T.
Matrix6d withoutSharedInformation(const Matrix6d& covariance, const Matrix6d& planes, double strength) {
  const Matrix6d C = covariance.llt().matrixL();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(C.transpose() * planes * C);
  const Vector6d m = eigen.eigenvalues().cwiseMax(0.0);
  const Vector6d factor = (1.0 + strength * m.array() / (1.0 + m.array())).matrix();
  const Matrix6d root = C * eigen.eigenvectors();
  return root * factor.asDiagonal() * root.transpose();
}

}  // namespace sgraphs
