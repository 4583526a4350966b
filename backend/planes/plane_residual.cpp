#include "backend/planes/plane_residual.h"

#include "common/geometry/tangent_basis.h"

namespace sgraphs {

namespace {

// By the pose, of a plane that lies in body at this normal, seen at the observation's axes and centroid.
Eigen::Matrix<double, 3, 6> byPose(const PlaneObservation& z, const Eigen::Vector3d& n_body) {
  Eigen::Matrix<double, 3, 6> J = Eigen::Matrix<double, 3, 6>::Zero();
  J.block<2, 3>(0, 3) = tangentBasis(z.normal_body).transpose() * skew(n_body);
  J.block<1, 3>(2, 0) = -n_body.transpose();
  J.block<1, 3>(2, 3) = -z.centroid_body.cross(n_body).transpose();
  return J;
}

}  // namespace

Eigen::Matrix<double, 3, 6> observationByPose(const PlaneObservation& z) {
  return byPose(z, z.normal_body);
}

PlaneResidual planeResidual(const PlaneObservation& z, const SE3& T_map_body, const PlaneNode& plane) {
  const Eigen::Matrix3d R = T_map_body.matrix3();
  const Eigen::Matrix<double, 2, 3> Bt = tangentBasis(z.normal_body).transpose();
  const TangentBasis U = tangentBasis(plane.normal_map);
  const Eigen::Vector3d n_body = R.transpose() * plane.normal_map;
  const Eigen::Vector3d lever = T_map_body * z.centroid_body - plane.anchor_map;

  PlaneResidual r;
  r.value << Bt * n_body, -plane.normal_map.dot(lever) - plane.offset_m;
  r.by_pose = byPose(z, n_body);
  r.by_plane.setZero();
  r.by_plane.block<2, 2>(0, 0) = Bt * R.transpose() * U;
  r.by_plane.block<1, 2>(2, 0) = -lever.transpose() * U;
  r.by_plane(2, 2) = -1.0;
  return r;
}

Eigen::Matrix3d alongNormal(const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d sign(1, 1, -1);
  return sign.asDiagonal() * covariance * sign.asDiagonal();
}

Eigen::Matrix3d reframedCovariance(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& normal_then,
                                   const Eigen::Vector3d& normal_now) {
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J.topLeftCorner<2, 2>() = tangentTurn(normal_then, normal_now);
  return J * covariance * J.transpose();
}

// The residual is zero where pose, plane and observation agree: by_pose d_pose + by_plane d_plane = d_z.
Eigen::Matrix3d observedPlaneCovariance(const PlaneObservation& z, const SE3& T_map_body,
                                        const Matrix6d& pose) {
  PlaneNode plane;
  plane.normal_map = T_map_body.rotation * z.normal_body;
  plane.anchor_map = T_map_body * z.centroid_body;
  const PlaneResidual r = planeResidual(z, T_map_body, plane);
  const Eigen::Matrix3d A = r.by_plane.inverse();
  return A * (z.covariance + r.by_pose * pose * r.by_pose.transpose()) * A.transpose();
}

}  // namespace sgraphs
