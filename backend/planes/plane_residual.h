#pragma once

#include "backend/factors/plane_state.h"
#include "backend/graph/situational_graph.h"

namespace sgraphs {

// What an observation says of a plane: (tilt_u, tilt_v, offset) by which the plane is off the observation,
// seen in body, with the Jacobians by the pose's tangent and the plane's (tilt_u, tilt_v, offset at anchor).
struct PlaneResidual {
  Eigen::Vector3d value;  // [rad, rad, m]
  Eigen::Matrix<double, 3, 6> by_pose;
  Eigen::Matrix3d by_plane;
};
PlaneResidual planeResidual(const PlaneObservation& z, const SE3& T_map_body, const PlaneNode& plane);

// How an observation's (tilt_u, tilt_v, offset) changes with the pose it is seen from, tangent of body.
Eigen::Matrix<double, 3, 6> observationByPose(const PlaneObservation& z);

// A plane state's offset moves it against its normal, n.(p - a) + offset = 0; what nodes, messages and files
// say of an offset is along it (plane_t). The step from either to the other.
Eigen::Matrix3d alongNormal(const Eigen::Matrix3d& covariance);

// Covariance of a plane's tangent for a normal that has turned a little or with the whole map: the axes are a
// function of the normal, and flip where its z changes sign.
Eigen::Matrix3d reframedCovariance(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& normal_then,
                                   const Eigen::Vector3d& normal_now);

// Covariance (of a state's tangent anchored at the observation's centroid) of a plane in map that was seen
// once, from a pose with this covariance.
Eigen::Matrix3d observedPlaneCovariance(const PlaneObservation& z, const SE3& T_map_body,
                                        const Matrix6d& pose);

}  // namespace sgraphs
