#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "backend/graph/situational_graph.h"
#include "backend/planes/plane_extent.h"
#include "common/geometry/tangent_basis.h"

namespace sgraphs::testing_support {

// A flat rectangle in the world: centre, normal towards its visible side, half sizes along its own level axis
// and across it.
struct Face {
  Eigen::Vector3d centre, normal;
  double half_width_m = 2, half_height_m = 1.2;

  Eigen::Vector3d across() const {
    const Eigen::Vector3d up =
        std::abs(normal.z()) > 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
    return up.cross(normal).normalized();
  }
  std::vector<Eigen::Vector3d> corners() const {
    const Eigen::Vector3d u = half_width_m * across(), v = half_height_m * normal.cross(across());
    return {centre - u - v, centre + u - v, centre + u + v, centre - u + v};
  }
};

// The part of the face within reach of the body, seen if the body is on its visible side and the part is more
// than twice `least_half_m` long both ways.
inline std::optional<Face> visiblePart(const Face& face, const SE3& T_world_body, double reach_m,
                                       double least_half_m) {
  const Eigen::Vector3d to = T_world_body.translation - face.centre;
  const double height = to.dot(face.normal);
  if (height < 0.1 || height > reach_m) return std::nullopt;
  const double reach = std::sqrt(reach_m * reach_m - height * height);
  const Eigen::Vector3d u = face.across(), v = face.normal.cross(u);
  const auto clip = [&](double centre, double half, double& out_centre, double& out_half) {
    const double low = std::max(-half, centre - reach), high = std::min(half, centre + reach);
    out_centre = 0.5 * (low + high);
    out_half = 0.5 * (high - low);
    return out_half > least_half_m;
  };
  double cu = 0, cv = 0;
  Face part = face;
  if (!clip(to.dot(u), face.half_width_m, cu, part.half_width_m)) return std::nullopt;
  if (!clip(to.dot(v), face.half_height_m, cv, part.half_height_m)) return std::nullopt;
  part.centre = face.centre + cu * u + cv * v;
  return part;
}

inline Eigen::Matrix3d observationCovariance(double tilt_rad = 0.003, double offset_m = 0.004) {
  return Eigen::Vector3d(tilt_rad * tilt_rad, tilt_rad * tilt_rad, offset_m * offset_m).asDiagonal();
}

// The face as the body at this pose sees it, without noise.
inline PlaneObservation observe(const Face& face, const SE3& T_world_body,
                                const Eigen::Matrix3d& covariance = observationCovariance()) {
  const SE3 T_body_world = T_world_body.inverse();
  PlaneObservation z;
  z.normal_body = T_body_world.rotation * face.normal;
  z.centroid_body = T_body_world * face.centre;
  z.covariance = covariance;
  z.num_points = 500;
  z.area_m2 = 4 * face.half_width_m * face.half_height_m;
  const TangentBasis axes = tangentBasis(z.normal_body);
  for (const Eigen::Vector3d& corner : face.corners())
    z.boundary.emplace_back((axes.transpose() * (T_body_world * corner - z.centroid_body)).cast<float>());
  return z;
}

// Noise drawn from the observation's own covariance.
inline PlaneObservation noisy(PlaneObservation z, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Eigen::Matrix3d L = z.covariance.llt().matrixL();
  const Eigen::Vector3d e = L * Eigen::Vector3d(normal(random), normal(random), normal(random));
  // The truth is at z + e.
  const TangentBasis axes = tangentBasis(z.normal_body);
  const Eigen::Vector3d n = z.normal_body;
  z.normal_body = (n - axes * e.head<2>()).normalized();
  z.centroid_body -= e.z() * n;
  return z;
}

inline PlaneNode planeOf(const Face& face, int64_t id = 0) {
  PlaneNode plane;
  plane.id = PlaneId{id};
  plane.floor = FloorId{0};
  plane.normal_map = face.normal;
  plane.anchor_map = face.centre;
  plane.covariance = observationCovariance();
  Polygon2d points;
  const TangentBasis axes = tangentBasis(face.normal);
  for (const Eigen::Vector3d& corner : face.corners())
    points.emplace_back(axes.transpose() * (corner - face.centre));
  setExtent(plane, points);
  return plane;
}

}  // namespace sgraphs::testing_support
