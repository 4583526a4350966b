#include "perception/free_space/clusters/segmentation.h"

#include <algorithm>

#include "common/geometry/convex_polygon.h"
#include "perception/free_space/clusters/basins.h"
#include "perception/free_space/clusters/contacts.h"
#include "perception/free_space/clusters/corridor_arms.h"

namespace sgraphs {
namespace {

// Cuts at the narrow places, with the borders moved onto them.
std::vector<Cut> cutAtNarrows(const StoreyGrid& grid, Regions& regions) {
  std::vector<Cut> cuts;
  for (const Contact& contact : contactsOf(grid, regions.labels)) {
    const auto cut = narrowestAt(grid, regions.labels, contact);
    if (!cut) continue;
    straightenAt(grid, *cut, contact.a, contact.b, regions);
    cuts.push_back(*cut);
  }
  keepConnected(grid, regions);
  return cuts;
}

// The cut that a contact lies on: the one nearest to its widest cell.
const Cut* cutAt(const StoreyGrid& grid, const Contact& contact, const std::vector<Cut>& cuts) {
  const Eigen::Vector2d saddle = centerOf(grid, contact.saddle);
  const Cut* best = nullptr;
  double best_m = 0.4;
  for (const Cut& cut : cuts) {
    const double d_m = distanceToSegment(saddle, cut.left, cut.right);
    if (d_m >= best_m) continue;
    best_m = d_m;
    best = &cut;
  }
  return best;
}

// Turned so that it has left and right as seen when walking from a to b.
Cut turned(const StoreyGrid& grid, const CellLabels& labels, const Contact& contact, Cut cut) {
  double balance = 0;
  for (const uint32_t cell : contact.cells) {
    const double side = cross(cut.right - cut.left, centerOf(grid, cell) - cut.middle());
    balance += labels[cell] == contact.b ? side : -side;
  }
  if (balance < 0) std::swap(cut.left, cut.right);
  return cut;
}

}  // namespace

Segmentation segment(const StoreyGrid& rooms, const FreeSpaceGraphConfig& config,
                     const std::vector<Cut>& former) {
  Segmentation result;
  Regions& regions = result.regions;
  regions.labels = floodBasins(rooms, config, former, &regions.count);
  joinSmallRegions(rooms, config.min_cluster_m2, regions);
  joinThroughParallelGaps(rooms, config, regions);
  keepConnected(rooms, regions);
  std::vector<Cut> cuts = cutAtNarrows(rooms, regions);
  const std::vector<Cut> turns = cutCorridorArms(rooms, config, regions);
  cuts.insert(cuts.end(), turns.begin(), turns.end());
  joinSmallRegions(rooms, config.min_cluster_m2, regions);
  keepConnected(rooms, regions);
  for (const Contact& contact : contactsOf(rooms, regions.labels)) {
    const Cut* known = cutAt(rooms, contact, cuts);
    const auto cut = known ? std::optional<Cut>(*known) : narrowestAt(rooms, regions.labels, contact);
    if (cut) result.passages.push_back({contact.a, contact.b, turned(rooms, regions.labels, contact, *cut)});
  }
  return result;
}

}  // namespace sgraphs
