#include "backend/output/moved_away.h"

#include <cmath>

#include "backend/graph/map_plane.h"
#include "perception/free_space/free_space_evidence.h"

namespace sgraphs {
namespace {

constexpr int kMinPasses = 3;
constexpr int kPassesPerHit = 3;
// Rays that leave the highest slice upwards pass walls that go on above it.
constexpr int kNumSure = kNumSlices - 1;

// What all keyframes say of free space, from where they stand now.
FreeSpaceEvidence evidenceOf(const SituationalGraph& graph, const EvidenceConfig& config) {
  FreeSpaceEvidence evidence(config);
  bool first = true;
  for (const auto& [id, node] : graph.keyframes) {
    if (!node.keyframe) continue;
    MapUpdate update;
    update.newest = id;
    update.keyframes = {{id, floorOf(node), node.time, node.T_map_body}};
    if (first)
      for (const auto& [plane_id, plane] : graph.planes) update.planes.push_back(mapPlane(plane));
    first = false;
    evidence.take(*node.keyframe, update);
  }
  return evidence;
}

bool movedAway(const MapPoint& point, const StoreyMap& storey, double cell_m) {
  const double height_m = static_cast<double>(point.position_map.z()) - storey.surface_z_m();
  const int slice = static_cast<int>(std::floor((height_m - kLowestSlice_m) / kSlice_m));
  if (slice < 0 || slice >= kNumSure) return false;
  const auto cellOf = [cell_m](float p) {
    return static_cast<int>(std::floor(static_cast<double>(p) / cell_m));
  };
  const ColumnVotes votes =
      storey.evidence().at(cellOf(point.position_map.x()), cellOf(point.position_map.y()));
  const int hits = votes.hits[static_cast<size_t>(slice)], passes = votes.misses[static_cast<size_t>(slice)];
  return votes.walls == 0 && passes >= kMinPasses && passes > kPassesPerHit * hits;
}

}  // namespace

void dropWhatMovedAway(const SituationalGraph& graph, std::vector<MapPoint>& map) {
  const EvidenceConfig config;
  const FreeSpaceEvidence evidence = evidenceOf(graph, config);
  std::erase_if(map, [&](const MapPoint& point) {
    const auto storey = evidence.storeys().find(point.floor);
    return storey != evidence.storeys().end() && movedAway(point, storey->second, config.cell_m);
  });
}

}  // namespace sgraphs
