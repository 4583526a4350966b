#include "perception/rooms/cluster_border.h"

namespace sgraphs {
namespace {

// A little more than a cell's diagonal: the steps of a slanting wall go, jambs and pillars stay.
constexpr double kSteps_m = 0.15;

}  // namespace

ClusterBorder borderOf(const FreeSpaceCluster& cluster) {
  ClusterBorder border;
  const size_t n = cluster.border.size();
  for (const BorderCorner& corner : cluster.border)
    border.polygon.push_back(corner.position_map.cast<double>());
  if (n < 3) return border;
  // Runs of one kind begin where it changes; a border of one kind is cut at its first corner and the one
  // farthest from it.
  std::vector<size_t> starts;
  for (size_t i = 0; i < n; ++i)
    if (cluster.border[i].kind != cluster.border[(i + n - 1) % n].kind) starts.push_back(i);
  if (starts.size() < 2) {
    size_t farthest = 1;
    for (size_t i = 2; i < n; ++i)
      if ((border.polygon[i] - border.polygon[0]).norm() >
          (border.polygon[farthest] - border.polygon[0]).norm())
        farthest = i;
    starts = {0, farthest};
  }
  for (size_t k = 0; k < starts.size(); ++k) {
    const size_t first = starts[k], last = starts[(k + 1) % starts.size()];
    Polygon2d run{border.polygon[first]};
    for (size_t i = first; i != last; i = (i + 1) % n) run.push_back(border.polygon[(i + 1) % n]);
    const std::vector<size_t> corners = straightened(run, kSteps_m);
    for (size_t i = 0; i + 1 < corners.size(); ++i) {
      const BorderEdge edge{run[corners[i]], run[corners[i + 1]], cluster.border[first].kind};
      if (edge.length() < 1e-9) continue;
      border.edges.push_back(edge);
      border.length_m += edge.length();
      if (edge.kind == BorderKind::kFrontier) border.frontier_m += edge.length();
    }
  }
  return border;
}

}  // namespace sgraphs
