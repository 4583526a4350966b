#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "common/geometry/tangent_basis.h"
#include "tests/backend/output/synthetic_run.h"

namespace sgraphs::test {

// A rectangle in map as a mapped plane: half extents along a level axis and across it.
inline PlaneNode rectanglePlane(PlaneId id, PlaneLabel label, const Eigen::Vector3d& normal,
                                const Eigen::Vector3d& center, double half_length_m, double half_height_m) {
  PlaneNode plane;
  plane.id = id;
  plane.label = label;
  plane.floor = {0};
  plane.normal_map = normal.normalized();
  plane.anchor_map = plane.centroid_map = center;
  const Eigen::Vector3d level =
      label == PlaneLabel::kHorizontal ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d a = level.cross(plane.normal_map).normalized();  // a x b = normal
  const Eigen::Vector3d b = plane.normal_map.cross(a);
  for (const auto& [s, t] :
       {std::pair(-1.0, -1.0), std::pair(1.0, -1.0), std::pair(1.0, 1.0), std::pair(-1.0, 1.0)})
    plane.polygon_map.push_back(center + s * half_length_m * a + t * half_height_m * b);
  plane.covariance = Eigen::Vector3d(1e-6, 4e-6, 9e-6).asDiagonal();
  plane.covariance(0, 2) = plane.covariance(2, 0) = 1e-6;
  return plane;
}

// What a keyframe sees of a plane, without error.
inline PlaneObservation seenFrom(const SE3& T_map_body, const PlaneNode& plane) {
  PlaneObservation seen;
  const SE3 T_body_map = T_map_body.inverse();
  seen.normal_body = T_body_map.rotation * plane.normal_map;
  seen.centroid_body = T_body_map * plane.centroid_map;
  seen.covariance = Eigen::Vector3d(4e-6, 2e-5, 1e-4).asDiagonal();
  seen.covariance(0, 1) = seen.covariance(1, 0) = 4e-6;
  seen.covariance(1, 2) = seen.covariance(2, 1) = 1e-5;
  seen.num_points = 100;
  seen.boundary = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  return seen;
}

// Four walls, the floor and the ceiling of the room, each seen from every keyframe: w0 to w5.
inline void addRoomPlanes(const BoxRoom& room, SituationalGraph& graph) {
  const Eigen::Vector3d center = 0.5 * (room.min + room.max), half = 0.5 * (room.max - room.min);
  graph.floors[{0}] = {{0}, center.head<2>(), true, room.min.z()};
  for (int64_t i = 0; i < 6; ++i) {
    const int axis = static_cast<int>(i / 2);
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    normal[axis] = i % 2 ? 1 : -1;  // inwards
    const Eigen::Vector3d at = center - half[axis] * normal;
    const PlaneLabel label = static_cast<PlaneLabel>(axis + 1);
    const double length = axis == 2 ? half.y() : half[1 - axis], height = axis == 2 ? half.x() : half.z();
    graph.planes[{i}] = rectanglePlane({i}, label, normal, at, length, height);
  }
  int64_t next = 1000;
  for (const auto& [k, keyframe] : graph.keyframes)
    for (auto& [w, plane] : graph.planes) {
      graph.observations.push_back({next++, k, w, seenFrom(keyframe.T_map_body, plane)});
      ++plane.num_observations;
    }
  graph.faces.push_back({next, {0}, {1}, 1e-3});
}

}  // namespace sgraphs::test
