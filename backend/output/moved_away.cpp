#include "backend/output/moved_away.h"

#include <cmath>

#include "backend/output/left_out_walls.h"
#include "common/geometry/convex_polygon.h"
#include "common/geometry/tangent_basis.h"

namespace sgraphs {
namespace {

constexpr int kMinPasses = 3;
constexpr int kPassesPerHit = 3;
// People end below the second highest slice. Rays that leave the highest one upwards pass walls that go on
// above it, so that one says nothing.
constexpr double kTallSlice_m = 0.25;
constexpr int kNumSure = kNumSlices - 1;
// Whom the robot meets is a plane for two or three keyframes; a pane that it walks past is one for more.
constexpr int64_t kFewObservations = 3;
constexpr double kSample_m = 0.1;
constexpr int kMinSamples = 5;

// What all keyframes say of free space, from where they stand now.
FreeSpaceEvidence evidenceOf(const SituationalGraph& graph) {
  FreeSpaceEvidence evidence(EvidenceConfig{}, kTallSlice_m);
  for (const auto& [id, node] : graph.keyframes) {
    if (!node.keyframe) continue;
    MapUpdate update;
    update.newest = id;
    update.keyframes = {{id, floorOf(node), node.time, node.T_map_body}};
    evidence.take(*node.keyframe, update);
  }
  return evidence;
}

// Places on the plane within its polygon, kSample_m apart.
std::vector<Eigen::Vector3d> samplesOf(const PlaneNode& plane) {
  const auto axes = tangentBasis(plane.normal_map);
  Polygon2d outline;
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = low;
  for (const Eigen::Vector3d& corner : plane.polygon_map) {
    outline.emplace_back(axes.transpose() * (corner - plane.centroid_map));
    low = low.cwiseMin(outline.back());
    high = high.cwiseMax(outline.back());
  }
  std::vector<Eigen::Vector3d> samples;
  for (double u = low.x(); u <= high.x(); u += kSample_m)
    for (double v = low.y(); v <= high.y(); v += kSample_m)
      if (contains(outline, {u, v})) samples.push_back(plane.centroid_map + axes * Eigen::Vector2d(u, v));
  return samples;
}

}  // namespace

MovedAway::MovedAway(const SituationalGraph& graph) : evidence_(evidenceOf(graph)) {}

MovedAway::Place MovedAway::at(const Eigen::Vector3d& p_map, FloorId floor) const {
  const auto storey = evidence_.storeys().find(floor);
  if (storey == evidence_.storeys().end()) return Place::kUnknown;
  const double height_m = p_map.z() - storey->second.surface_z_m();
  const int slice = static_cast<int>(std::floor((height_m - kLowestSlice_m) / kTallSlice_m));
  if (slice < 0 || slice >= kNumSure) return Place::kUnknown;
  const double cell_m = EvidenceConfig{}.cell_m;
  const ColumnVotes votes = storey->second.evidence().at(static_cast<int>(std::floor(p_map.x() / cell_m)),
                                                         static_cast<int>(std::floor(p_map.y() / cell_m)));
  const int hits = votes.hits[static_cast<size_t>(slice)], passes = votes.misses[static_cast<size_t>(slice)];
  if (hits + passes == 0) return Place::kUnknown;
  return passes >= kMinPasses && passes > kPassesPerHit * hits ? Place::kMovedAway : Place::kStands;
}

void MovedAway::dropFrom(std::vector<MapPoint>& map) const {
  std::erase_if(map, [&](const MapPoint& point) {
    return at(point.position_map.cast<double>(), point.floor) == Place::kMovedAway;
  });
}

bool MovedAway::walkedPast(const PlaneNode& plane) const {
  if (plane.label == PlaneLabel::kHorizontal || plane.num_observations > kFewObservations) return false;
  int gone = 0, known = 0;
  for (const Eigen::Vector3d& p : samplesOf(plane)) {
    const Place place = at(p, plane.floor);
    known += place != Place::kUnknown;
    gone += place == Place::kMovedAway;
  }
  return known >= kMinSamples && 2 * gone > known;
}

std::set<PlaneId> MovedAway::whoWalkedPast(const SituationalGraph& graph) const {
  const std::set<PlaneId> needed = wallsOfRooms(graph);
  std::set<PlaneId> gone;
  for (const auto& [id, plane] : graph.planes)
    if (!needed.contains(id) && walkedPast(plane)) gone.insert(id);
  return gone;
}

}  // namespace sgraphs
