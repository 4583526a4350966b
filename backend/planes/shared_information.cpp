#include "backend/planes/shared_information.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "backend/planes/plane_residual.h"

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

// With S = diag(sigma), N = S sum(J^T R^-1 J) S counts planes: a plane that is sure of a direction but for
// the shared error adds 1 to it. R + J S (max(N, 1) - 1) S J^T.
void keepSharedError(const Vector6d& pose_sigma, std::vector<PlaneObservation>& planes) {
  Matrix6d information = Matrix6d::Zero();
  for (const PlaneObservation& z : planes) {
    const Eigen::Matrix<double, 3, 6> J = observationByPose(z);
    information += J.transpose() * z.covariance.inverse() * J;
  }
  const Matrix6d S = pose_sigma.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(S * information * S);
  const Vector6d more = (eigen.eigenvalues().array() - 1.0).max(0.0).matrix();
  const Matrix6d root = S * eigen.eigenvectors();
  const Matrix6d extra = root * more.asDiagonal() * root.transpose();
  for (PlaneObservation& z : planes) {
    const Eigen::Matrix<double, 3, 6> J = observationByPose(z);
    z.covariance += J * extra * J.transpose();
    z.covariance = (0.5 * (z.covariance + z.covariance.transpose())).eval();
  }
}

}  // namespace sgraphs
