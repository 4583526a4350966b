#include <Eigen/Cholesky>
#include <cmath>
#include <stdexcept>

#include "lcmtypes/convert/convert.h"

namespace sgraphs {
namespace {

// A point that is said to lie on the plane may miss it by this much.
constexpr double kOnPlane_m = 1e-3;

bool isLabel(int8_t label) {
  return label == graph_plane_t::X || label == graph_plane_t::Y || label == graph_plane_t::HORIZONTAL;
}

bool isPlane(const MapPlane& plane) {
  const bool finite = plane.normal_map.allFinite() && std::isfinite(plane.d) &&
                      plane.centroid_map.allFinite() && plane.covariance.allFinite();
  if (!finite || std::abs(plane.normal_map.norm() - 1.0) > 1e-6) return false;
  if (std::abs(plane.normal_map.dot(plane.centroid_map) + plane.d) > kOnPlane_m) return false;
  for (const Eigen::Vector3f& corner : plane.polygon_map)
    if (!corner.allFinite()) return false;
  return plane.covariance.llt().info() == Eigen::Success;
}

}  // namespace

graph_plane_t toMessage(const MapPlane& plane) {
  if (plane.polygon_map.size() > kMaxMapPlaneCorners)
    throw std::logic_error("mapped plane with more corners than a message holds");
  graph_plane_t m{};
  m.id = plane.id.value;
  m.merged_into = plane.merged_into.value;
  if (plane.merged_into.valid()) return m;
  m.floor = plane.floor.value;
  m.label = static_cast<int8_t>(plane.label);
  m.d = plane.d;
  for (int i = 0; i < 3; ++i) {
    m.normal[i] = plane.normal_map[i];
    m.centroid[i] = plane.centroid_map[i];
  }
  int k = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = r; c < 3; ++c) m.covariance[k++] = plane.covariance(r, c);
  for (const Eigen::Vector3f& corner : plane.polygon_map)
    m.polygon.push_back({corner.x(), corner.y(), corner.z()});
  m.num_corners = static_cast<int32_t>(m.polygon.size());
  return m;
}

std::optional<MapPlane> fromMessage(const graph_plane_t& m) {
  if (m.id < 0 || m.merged_into < -1 || m.merged_into == m.id) return std::nullopt;
  MapPlane plane;
  plane.id = PlaneId{m.id};
  plane.merged_into = PlaneId{m.merged_into};
  if (plane.merged_into.valid()) return plane;
  if (m.floor < -1 || !isLabel(m.label) || m.num_corners < 3 || m.num_corners > kMaxMapPlaneCorners)
    return std::nullopt;
  plane.floor = FloorId{m.floor};
  plane.label = static_cast<PlaneLabel>(m.label);
  plane.normal_map = Eigen::Vector3d(m.normal);
  plane.d = m.d;
  plane.centroid_map = Eigen::Vector3d(m.centroid);
  int k = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = r; c < 3; ++c) plane.covariance(r, c) = plane.covariance(c, r) = m.covariance[k++];
  for (const auto& corner : m.polygon) plane.polygon_map.emplace_back(corner[0], corner[1], corner[2]);
  if (!isPlane(plane)) return std::nullopt;
  return plane;
}

}  // namespace sgraphs
