#include "backend/graph/map_plane.h"

#include <stdexcept>

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

PlaneId livesOnIn(const SituationalGraph& graph, PlaneId id) {
  size_t steps = 0;
  for (auto it = graph.merged_planes.find(id); it != graph.merged_planes.end();
       it = graph.merged_planes.find(id)) {
    id = it->second;
    if (++steps > graph.merged_planes.size()) throw std::logic_error("graph: planes merged in a circle");
  }
  return id;
}

PlaneId livingPlane(const SituationalGraph& graph, PlaneId id) {
  const PlaneId living = livesOnIn(graph, id);
  return graph.planes.contains(living) ? living : PlaneId{};
}

}  // namespace sgraphs
