#include "perception/free_space/clusters/wall_gaps.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/geometry/convex_polygon.h"
#include "perception/free_space/clusters/cell_rays.h"
#include "perception/free_space/clusters/narrowness.h"
#include "perception/free_space/clusters/region_border.h"
#include "perception/free_space/clusters/region_cuts.h"

namespace sgraphs {
namespace {

constexpr double kMinSideWall_m = 0.4;  // of the wall on each side of the gap
constexpr double kMaxOffset_m = 0.25;   // between the lines of the two walls: a wall's thickness
constexpr double kMinAlong = 0.96;      // cosine of the angle between them
constexpr double kMinDepth_m = 1.0;     // of the space on both sides
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
    if (isWall(loop, before, here_on, kMinSideWall_m))
      ends.push_back({loop.label, loop.corners[here], lineOf(loop, before, here_on, cell_m).direction});
    if (isWall(loop, here, to, kMinSideWall_m))
      ends.push_back({loop.label, loop.corners[here], -lineOf(loop, here, to, cell_m).direction});
  }
}

bool face(const WallEnd& a, const WallEnd& b, double max_gap_m) {
  if (a.label != b.label || a.along.dot(b.along) > -kMinAlong) return false;
  const Eigen::Vector2d gap = b.corner - a.corner;
  return gap.norm() <= max_gap_m && gap.dot(a.along) > 0.3 &&
         std::max(std::abs(cross(a.along, gap)), std::abs(cross(b.along, gap))) <= kMaxOffset_m;
}

// The narrowest line parallel to the gap, within the thickness of walls, that crosses the region from
// obstacle to obstacle; none where there is no space behind it on both sides.
std::optional<Cut> narrowestIn(const StoreyGrid& grid, const CellLabels& labels, const WallEnd& a,
                               const WallEnd& b) {
  const Eigen::Vector2d along = (b.corner - a.corner).normalized(), across(-along.y(), along.x());
  const double gap_m = (b.corner - a.corner).norm();
  std::optional<Cut> best;
  for (int k = -6; k <= 6; ++k) {
    const Eigen::Vector2d p = 0.5 * (a.corner + b.corner) + 0.5 * k * grid.cell_m * across;
    if (labelAt(grid, labels, p) != a.label) continue;
    const double back_m = reachWithin(grid, labels, p, -along, a.label, gap_m) + 0.5 * grid.cell_m;
    const double on_m = reachWithin(grid, labels, p, along, a.label, gap_m) + 0.5 * grid.cell_m;
    if (!best || back_m + on_m < best->width()) best = Cut{p - back_m * along, p + on_m * along, true};
  }
  if (!best || best->width() > gap_m + 3 * grid.cell_m || best->width() < gap_m - 5 * grid.cell_m)
    return std::nullopt;
  for (const double side : {-1.0, 1.0})
    if (reachWithin(grid, labels, best->middle(), side * across, a.label, kMinDepth_m) < kMinDepth_m - 0.01)
      return std::nullopt;
  return best;
}

}  // namespace

std::vector<Cut> cutWallGaps(const StoreyGrid& grid, const FreeSpaceGraphConfig& config,
                             const std::vector<Cut>& former, Regions& regions) {
  std::vector<WallEnd> ends;
  for (const CellLoop& loop : loopsOf(grid, regions.labels)) addEnds(loop, grid.cell_m, ends);
  std::vector<std::pair<WallEnd, WallEnd>> gaps;
  for (size_t i = 0; i < ends.size(); ++i)
    for (size_t j = i + 1; j < ends.size(); ++j)
      if (face(ends[i], ends[j], config.max_passage_m)) gaps.emplace_back(ends[i], ends[j]);
  // Where a cut was, it is looked at again, whatever has become of the walls beside it.
  for (const Cut& old : former) {
    const int32_t label = labelAt(grid, regions.labels, old.middle());
    if (!old.narrows || label == kNoLabel) continue;
    const Eigen::Vector2d along = (old.right - old.left).normalized();
    gaps.push_back({{label, old.left, along}, {label, old.right, -along}});
  }
  const auto width = [](const auto& gap) { return (gap.second.corner - gap.first.corner).norm(); };
  std::stable_sort(gaps.begin(), gaps.end(),
                   [&width](const auto& a, const auto& b) { return width(a) < width(b); });
  std::vector<Cut> cuts;
  RegionCutter cutter(grid, regions);
  for (const auto& [a, b] : gaps) {
    const auto cut = narrowestIn(grid, regions.labels, a, b);
    if (!cut || relativeWidth(grid, regions.labels, *cut, a.label) >= widthLimit(config, former, *cut))
      continue;
    cuts.push_back(*cut);
    cutter.cut(*cut);
  }
  cutter.finish();
  return cuts;
}

}  // namespace sgraphs
