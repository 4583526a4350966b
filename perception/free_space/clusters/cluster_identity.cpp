#include "perception/free_space/clusters/cluster_identity.h"

#include <cmath>
#include <map>

namespace sgraphs {

std::vector<ClusterId> ClusterIdentity::identify(const StoreyGrid& grid, const Regions& regions,
                                                 int64_t* next) {
  // Grids grow by whole cells.
  const Eigen::Vector2d shift = (grid.origin_map - former_grid_.origin_map) / grid.cell_m;
  const int dx = static_cast<int>(std::lround(shift.x())), dy = static_cast<int>(std::lround(shift.y()));
  std::map<int64_t, std::map<int32_t, int>> shared;  // former id, region: cells
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const int32_t label = regions.labels[grid.index(x, y)];
      if (label == kNoLabel || !former_grid_.contains(x + dx, y + dy)) continue;
      const int64_t id = former_ids_[former_grid_.index(x + dx, y + dy)];
      if (id >= 0) ++shared[id][label];
    }
  std::vector<ClusterId> ids(static_cast<size_t>(regions.count));
  for (const auto& [id, cells] : shared) {
    auto most = cells.begin();
    for (auto it = cells.begin(); it != cells.end(); ++it)
      if (it->second > most->second) most = it;
    ClusterId& taken = ids[static_cast<size_t>(most->first)];
    if (!taken.valid()) taken = ClusterId{id};  // ascending: the lowest comes first
  }
  for (ClusterId& id : ids)
    if (!id.valid()) id = ClusterId{(*next)++};
  former_grid_ = grid;
  former_grid_.state.clear();
  former_grid_.clearance_m.clear();
  former_ids_.assign(regions.labels.size(), -1);
  for (size_t i = 0; i < regions.labels.size(); ++i)
    if (regions.labels[i] != kNoLabel) former_ids_[i] = ids[static_cast<size_t>(regions.labels[i])].value;
  return ids;
}

}  // namespace sgraphs
