#include "perception/free_space/clusters/segmentation.h"

#include <algorithm>

#include "common/geometry/convex_polygon.h"
#include "perception/free_space/clusters/basins.h"
#include "perception/free_space/clusters/contacts.h"
#include "perception/free_space/clusters/corridor_arms.h"
#include "perception/free_space/clusters/narrowness.h"
#include "perception/free_space/clusters/wall_gaps.h"

namespace sgraphs {
namespace {

// Cuts at the narrow places, with the borders moved onto them.
std::vector<Cut> cutAtNarrows(const StoreyGrid& grid, double min_passage_m, Regions& regions) {
  std::vector<Cut> cuts;
  for (const Contact& contact : contactsOf(grid, regions.labels)) {
    const auto cut = narrowestAt(grid, regions.labels, contact);
    if (!cut || cut->width() < min_passage_m) continue;
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

// Small regions that no passage leads to are the inside of things. Nobody has been there.
void dropPockets(const StoreyGrid& grid, double max_area_m2, Segmentation& segmentation) {
  Regions& regions = segmentation.regions;
  std::vector<double> area_m2(static_cast<size_t>(regions.count), 0);
  for (const int32_t label : regions.labels)
    if (label != kNoLabel) area_m2[static_cast<size_t>(label)] += grid.cell_m * grid.cell_m;
  for (const RegionPassage& passage : segmentation.passages)
    area_m2[static_cast<size_t>(passage.a)] = area_m2[static_cast<size_t>(passage.b)] = max_area_m2;
  std::vector<int32_t> name(area_m2.size(), kNoLabel);
  regions.count = 0;
  for (size_t i = 0; i < name.size(); ++i)
    if (area_m2[i] >= max_area_m2) name[i] = regions.count++;
  for (int32_t& label : regions.labels)
    if (label != kNoLabel) label = name[static_cast<size_t>(label)];
  for (RegionPassage& passage : segmentation.passages) {
    passage.a = name[static_cast<size_t>(passage.a)];
    passage.b = name[static_cast<size_t>(passage.b)];
  }
}

}  // namespace

Segmentation segment(const StoreyGrid& rooms, const FreeSpaceGraphConfig& config,
                     const std::vector<Cut>& former) {
  Segmentation result;
  Regions& regions = result.regions;
  regions.labels = floodBasins(rooms, config, &regions.count);
  joinSmallRegions(rooms, config.min_cluster_m2, regions);
  joinWhereWide(rooms, config, former, regions);
  joinThroughParallelGaps(rooms, config, regions);
  keepConnected(rooms, regions);
  std::vector<Cut> cuts = cutAtNarrows(rooms, config.min_passage_m, regions);
  const std::vector<Cut> gaps = cutWallGaps(rooms, config, former, regions);
  cuts.insert(cuts.end(), gaps.begin(), gaps.end());
  const std::vector<Cut> turns = cutCorridorArms(rooms, config, regions);
  cuts.insert(cuts.end(), turns.begin(), turns.end());
  joinSmallRegions(rooms, config.min_cluster_m2, regions);
  keepConnected(rooms, regions);
  for (const Contact& contact : contactsOf(rooms, regions.labels)) {
    const Cut* known = cutAt(rooms, contact, cuts);
    const auto cut = known ? std::optional<Cut>(*known) : narrowestAt(rooms, regions.labels, contact);
    if (cut && cut->width() >= config.min_passage_m)
      result.passages.push_back({contact.a, contact.b, turned(rooms, regions.labels, contact, *cut)});
  }
  dropPockets(rooms, 3 * config.min_cluster_m2, result);
  return result;
}

}  // namespace sgraphs
