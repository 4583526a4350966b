#include "perception/free_space/clusters/wall_gaps.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/convex_polygon.h"
#include "perception/free_space/clusters/cell_rays.h"
#include "perception/free_space/clusters/narrowness.h"
#include "perception/free_space/clusters/region_border.h"
#include "perception/free_space/clusters/region_cuts.h"

namespace sgraphs {
namespace {

constexpr double kMinWall_m = 0.4;     // of the wall on each side of the gap
constexpr double kMaxOffset_m = 0.25;  // between the lines of the two walls: a wall's thickness
constexpr double kMinAlong = 0.96;     // cosine of the angle between them
constexpr double kMinDepth_m = 1.0;    // of the space on both sides
constexpr double kMinTurn_rad = 0.6;

// Where a wall ends; `along` points on in its line.
struct WallEnd {
  int32_t label = kNoLabel;
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();
  Eigen::Vector2d along = Eigen::Vector2d::Zero();
};

void addEnds(const CellLoop& loop, double cell_m, std::vector<WallEnd>& ends) {
  const std::vector<size_t> stay = simplifiedLoop(loop, {}, 1.2 * cell_m);
  const size_t n = stay.size(), size = loop.corners.size();
  for (size_t k = 0; n > 3 && k < n; ++k) {
    const size_t here = stay[k], before = stay[(k + n - 1) % n], after = stay[(k + 1) % n];
    const Eigen::Vector2d in = loop.corners[here] - loop.corners[before];
    const Eigen::Vector2d out = loop.corners[after] - loop.corners[here];
    const double turn_rad = std::atan2(cross(in, out), in.dot(out));
    // To the right, or back.
    if (turn_rad > -kMinTurn_rad && turn_rad < M_PI - 0.4) continue;
    const size_t here_on = here > before ? here : here + size, to = after > here ? after : after + size;
    if (isWall(loop, before, here_on, kMinWall_m))
      ends.push_back({loop.label, loop.corners[here], lineOf(loop, before, here_on, cell_m).direction});
    if (isWall(loop, here, to, kMinWall_m))
      ends.push_back({loop.label, loop.corners[here], -lineOf(loop, here, to, cell_m).direction});
  }
}

bool face(const WallEnd& a, const WallEnd& b, double max_gap_m) {
  if (a.label != b.label || a.along.dot(b.along) > -kMinAlong) return false;
  const Eigen::Vector2d gap = b.corner - a.corner;
  return gap.norm() <= max_gap_m && gap.dot(a.along) > 0.3 &&
         std::max(std::abs(cross(a.along, gap)), std::abs(cross(b.along, gap))) <= kMaxOffset_m;
}

// Free all the way, with something behind on both sides.
bool isOpening(const StoreyGrid& grid, const CellLabels& labels, const Cut& cut, int32_t label) {
  const Eigen::Vector2d along = (cut.right - cut.left).normalized(), across(-along.y(), along.x());
  if (labelAt(grid, labels, cut.middle()) != label) return false;
  const double free_m = reachWithin(grid, labels, cut.middle(), along, label, cut.width()) +
                        reachWithin(grid, labels, cut.middle(), -along, label, cut.width());
  return free_m > cut.width() - 3 * grid.cell_m &&
         reachWithin(grid, labels, cut.middle(), across, label, kMinDepth_m) >= kMinDepth_m - 0.01 &&
         reachWithin(grid, labels, cut.middle(), -across, label, kMinDepth_m) >= kMinDepth_m - 0.01;
}

}  // namespace

std::vector<Cut> cutWallGaps(const StoreyGrid& grid, const FreeSpaceGraphConfig& config,
                             const std::vector<Cut>& former, Regions& regions) {
  std::vector<WallEnd> ends;
  for (const CellLoop& loop : loopsOf(grid, regions.labels)) addEnds(loop, grid.cell_m, ends);
  std::vector<std::pair<Cut, int32_t>> gaps;
  for (size_t i = 0; i < ends.size(); ++i)
    for (size_t j = i + 1; j < ends.size(); ++j)
      if (face(ends[i], ends[j], config.max_passage_m))
        gaps.push_back({{ends[i].corner, ends[j].corner, true}, ends[i].label});
  std::stable_sort(gaps.begin(), gaps.end(),
                   [](const auto& a, const auto& b) { return a.first.width() < b.first.width(); });
  std::vector<Cut> cuts;
  RegionCutter cutter(grid, regions);
  for (const auto& [cut, label] : gaps) {
    if (!isOpening(grid, regions.labels, cut, label)) continue;
    if (relativeWidth(grid, regions.labels, cut, label) >= widthLimit(config, former, cut)) continue;
    cuts.push_back(cut);
    cutter.cut(cut);
  }
  cutter.finish();
  return cuts;
}

}  // namespace sgraphs
