#include "backend/rooms/floor_walls.h"

#include <algorithm>
#include <cmath>

#include "backend/planes/plane_extent.h"

namespace sgraphs {
namespace {

constexpr double kLevel = 0.99;      // n.z of a walking surface
constexpr double kOpposed = -0.985;  // cosine: within 10 degrees
constexpr double kAcross = 0.7;      // cosine between the directions of two pairs
constexpr double kLeastWidth_m = 1.0;
constexpr double kStays_m = 0.25;
constexpr double kHeightGate_m = 0.3;

struct Candidate {
  std::pair<PlaneId, PlaneId> walls;
  Eigen::Vector3d normal;
  double width_m = 0;
  double rank_m = 0;
};

std::vector<Candidate> candidates(const SituationalGraph& graph, FloorId floor,
                                  const std::set<std::pair<PlaneId, PlaneId>>& before) {
  std::vector<const PlaneNode*> walls;
  for (const auto& [id, plane] : graph.planes)
    if (plane.floor == floor && std::abs(plane.normal_map.z()) < kPlumbNormal) walls.push_back(&plane);
  std::vector<Candidate> found;
  for (size_t i = 0; i < walls.size(); ++i)
    for (size_t j = i + 1; j < walls.size(); ++j) {
      const PlaneNode &a = *walls[i], &b = *walls[j];
      if (a.normal_map.dot(b.normal_map) > kOpposed) continue;
      // Positive on both sides if they face each other.
      const double width = std::min(a.distance(b.centroid_map), b.distance(a.centroid_map));
      if (width < kLeastWidth_m) continue;
      const double bonus = before.contains({a.id, b.id}) ? kStays_m : 0.0;
      found.push_back({{a.id, b.id}, a.normal_map, width, width + bonus});
    }
  return found;
}

}  // namespace

FloorWalls wallsOfFloor(const SituationalGraph& graph, FloorId floor,
                        const std::set<std::pair<PlaneId, PlaneId>>& before) {
  const std::vector<Candidate> all = candidates(graph, floor, before);
  FloorWalls result;
  if (all.empty()) return result;
  const Candidate* widest = &all.front();
  const Candidate* across = nullptr;
  for (const Candidate& c : all)
    if (c.rank_m > widest->rank_m) widest = &c;
  for (const Candidate& c : all)
    if (std::abs(c.normal.dot(widest->normal)) < kAcross && (across == nullptr || c.rank_m > across->rank_m))
      across = &c;
  for (const Candidate* c : {widest, across}) {
    if (c == nullptr) continue;
    result.pairs.push_back(c->walls);
    result.size_m = std::max(result.size_m, c->width_m);
  }
  return result;
}

PlaneId walkingSurface(const SituationalGraph& graph, FloorId floor, double z_m, PlaneId before) {
  PlaneId best;
  double area = 0;
  for (const auto& [id, plane] : graph.planes) {
    if (plane.floor != floor || plane.normal_map.z() < kLevel) continue;
    const double height = (plane.anchor_map - plane.offset_m * plane.normal_map).z();
    if (std::abs(height - z_m) > kHeightGate_m) continue;
    if (id == before) return id;
    const double extent = extentArea(plane);
    if (extent <= area) continue;
    area = extent;
    best = id;
  }
  return best;
}

}  // namespace sgraphs
