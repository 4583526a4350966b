#include "backend/graph/map_plane.h"

namespace sgraphs {

MapPlane mapPlane(const PlaneNode& node) {
  MapPlane plane;
  plane.id = node.id;
  plane.floor = node.floor;
  plane.label = node.label;
  plane.normal_map = node.normal_map;
  plane.d = node.d();
  plane.centroid_map = node.centroid_map - node.distance(node.centroid_map) * node.normal_map;
  plane.covariance = node.covariance;
  for (const Eigen::Vector3d& corner : node.polygon_map) plane.polygon_map.push_back(corner.cast<float>());
  return plane;
}

}  // namespace sgraphs
