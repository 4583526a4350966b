#include "backend/output/left_out_walls.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "backend/graph/map_plane.h"
#include "common/geometry/convex_polygon.h"
#include "common/geometry/tangent_basis.h"

namespace sgraphs {
namespace {

constexpr double kApart_m = 0.06;
const double kCosTurned = std::cos(6.0 * M_PI / 180.0);

Polygon2d outlineOn(const PlaneNode& plane, const PlaneNode& other) {
  const TangentBasis axes = tangentBasis(plane.normal_map);
  Polygon2d corners;
  for (const Eigen::Vector3d& corner : other.polygon_map)
    corners.emplace_back(axes.transpose() * (corner - plane.anchor_map));
  return convexHull(std::move(corners));
}

bool isCopy(const PlaneNode& plane, const PlaneNode& wall) {
  if (plane.floor != wall.floor || plane.num_observations >= wall.num_observations) return false;
  if (plane.normal_map.dot(wall.normal_map) < kCosTurned) return false;
  if (std::abs(wall.distance(plane.centroid_map)) > kApart_m) return false;
  const Polygon2d outline = outlineOn(wall, plane);
  return 2 * overlapArea(outline, outlineOn(wall, wall)) > polygonArea(outline);
}

}  // namespace

std::set<PlaneId> wallsOfRooms(const SituationalGraph& graph) {
  std::set<PlaneId> walls;
  for (const auto& [id, room] : graph.rooms)
    for (const PlaneId wall : room.seen.walls()) walls.insert(wall);
  for (const CenterWallsFactor& factor : graph.center_walls)
    if (factor.of.room.valid()) walls.insert({factor.a, factor.b});
  for (const RoomShapeFactor& factor : graph.room_shapes) walls.insert({factor.a, factor.b});
  return walls;
}

SituationalGraph withoutPlanes(const SituationalGraph& graph, const std::set<PlaneId>& planes) {
  const auto went = [&](PlaneId id) { return planes.contains(id); };
  SituationalGraph rest = graph;
  std::erase_if(rest.planes, [&](const auto& node) { return went(node.first); });
  std::erase_if(rest.merged_planes, [&](const auto& merge) { return went(livingPlane(graph, merge.first)); });
  std::erase_if(rest.observations, [&](const ObservationFactor& f) { return went(f.plane); });
  std::erase_if(rest.plane_ups, [&](const PlaneUpFactor& f) { return went(f.plane); });
  std::erase_if(rest.faces, [&](const FacesFactor& f) { return went(f.a) || went(f.b); });
  std::erase_if(rest.center_walls, [&](const CenterWallsFactor& f) { return went(f.a) || went(f.b); });
  return rest;
}

std::set<PlaneId> copiesOfWalls(const SituationalGraph& graph) {
  std::vector<const PlaneNode*> walls;
  for (const auto& [id, plane] : graph.planes)
    if (plane.label != PlaneLabel::kHorizontal) walls.push_back(&plane);
  // What is seen most often first: a copy has no copies.
  std::stable_sort(walls.begin(), walls.end(), [](const PlaneNode* a, const PlaneNode* b) {
    return a->num_observations > b->num_observations;
  });
  const std::set<PlaneId> needed = wallsOfRooms(graph);
  std::set<PlaneId> copies;
  for (size_t i = 0; i < walls.size(); ++i) {
    if (needed.contains(walls[i]->id)) continue;
    const bool copy = std::any_of(
        walls.begin(), walls.begin() + static_cast<std::ptrdiff_t>(i),
        [&](const PlaneNode* wall) { return !copies.contains(wall->id) && isCopy(*walls[i], *wall); });
    if (copy) copies.insert(walls[i]->id);
  }
  return copies;
}

}  // namespace sgraphs
