#include "perception/free_space/clusters/corridor_arms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/geometry/convex_polygon.h"
#include "perception/free_space/clusters/region_border.h"

namespace sgraphs {
namespace {

constexpr double kMinWall_m = 0.6;    // a shorter piece of wall has no direction on the grid
constexpr double kMinArm_m = 2.5;     // shorter ones are niches, whatever their width
constexpr double kMaxArmWidth_m = 4;  // wider ones are halls
constexpr double kMinTurn = 0.6;      // sine of the angle between the walls that meet, at least
constexpr double kSameWidth = 1.35;   // an arm's widths stay within this ratio

// A corner of a wall inside a bend, and one way to cut there.
struct Candidate {
  int32_t label = kNoLabel;
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();
  Eigen::Vector2d along = Eigen::Vector2d::Zero();  // of the cut: on in the line of one wall
  Eigen::Vector2d arm = Eigen::Vector2d::Zero();    // into the arm: along the other wall
};

struct Arm {
  Cut cut;
  double beside_m = 0;   // length of what it is cut off from
  bool goes_on = false;  // straight on beyond the cut
};

// Sides of a loop from one corner that stayed to the next, as a straight line.
Eigen::Vector2d directionOf(const CellLoop& loop, size_t begin, size_t end) {
  const size_t n = loop.corners.size();
  // Without the ends, where rounded corners and niches are.
  const size_t trim = (end - begin) / 6;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  const double count = static_cast<double>(end - begin - 2 * trim + 1);
  for (size_t i = begin + trim; i <= end - trim; ++i) mean += loop.corners[i % n] / count;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (size_t i = begin + trim; i <= end - trim; ++i) {
    const Eigen::Vector2d d = loop.corners[i % n] - mean;
    spread += d * d.transpose();
  }
  const double angle = 0.5 * std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1));
  const Eigen::Vector2d axis(std::cos(angle), std::sin(angle));
  return axis.dot(loop.corners[end % n] - loop.corners[begin % n]) < 0 ? Eigen::Vector2d(-axis) : axis;
}

bool isWall(const CellLoop& loop, size_t begin, size_t end) {
  const size_t n = loop.corners.size();
  size_t obstacles = 0;
  for (size_t i = begin; i < end; ++i) obstacles += loop.kinds[i % n] == BorderKind::kObstacle ? 1 : 0;
  return 2 * obstacles > end - begin &&
         (loop.corners[end % n] - loop.corners[begin % n]).norm() >= kMinWall_m;
}

void addCandidates(const CellLoop& loop, double cell_m, std::vector<Candidate>& candidates) {
  const std::vector<size_t> stay = simplifiedLoop(loop, {}, 1.6 * cell_m);
  const size_t n = stay.size();
  if (n < 4) return;
  for (size_t k = 0; k < n; ++k) {
    const size_t here = stay[k], size = loop.corners.size();
    const size_t before = k > 0 ? stay[k - 1] : stay[n - 1];
    const size_t after = k + 1 < n ? stay[k + 1] : stay[0];
    const size_t here_on = here > before ? here : here + size;
    const size_t to = after > here ? after : after + size;
    if (cross(loop.corners[here] - loop.corners[before], loop.corners[after] - loop.corners[here]) >= 0)
      continue;
    if (!isWall(loop, before, here_on) || !isWall(loop, here, to)) continue;
    const Eigen::Vector2d in = directionOf(loop, before, here_on), out = directionOf(loop, here, to);
    if (cross(in, out) > -kMinTurn) continue;
    candidates.push_back({loop.label, loop.corners[here], in, out});
    candidates.push_back({loop.label, loop.corners[here], -out, -in});
  }
}

// Looks at one candidate on the regions as they are now.
class ArmFinder {
 public:
  ArmFinder(const StoreyGrid& grid, const FreeSpaceGraphConfig& config, const CellLabels& labels)
      : grid_(grid), config_(config), labels_(labels) {}

  std::optional<Arm> find(const Candidate& at) const {
    const Eigen::Vector2d start = at.corner + 0.5 * grid_.cell_m * (at.along + at.arm);
    const int32_t label = labelAt(grid_, labels_, start);
    if (label == kNoLabel) return std::nullopt;
    const double cut_m = reach(start, at.along, label, kMaxArmWidth_m * 1.5);
    const double width_m = cut_m * std::abs(cross(at.along, at.arm));
    if (width_m < 4 * grid_.cell_m || width_m > kMaxArmWidth_m) return std::nullopt;
    const Eigen::Vector2d end = start + (cut_m + 0.5 * grid_.cell_m) * at.along;
    if (!obstacleNear(end)) return std::nullopt;
    if (!isArm(start, cut_m, width_m, at, label)) return std::nullopt;
    Arm arm;
    arm.cut = {start - grid_.cell_m * at.along, end, false};
    arm.beside_m = besideLength(start + 0.5 * cut_m * at.along, width_m, at, label);
    if (arm.beside_m < 2 * width_m) return std::nullopt;
    const double straight_m = straightLength(start + 0.5 * cut_m * at.along, width_m, at, label);
    arm.goes_on = straight_m > 0;
    if (straight_m >= arm.beside_m) return std::nullopt;
    return arm;
  }

 private:
  double reach(const Eigen::Vector2d& from, const Eigen::Vector2d& direction, int32_t label,
               double max_m) const {
    const double step_m = 0.5 * grid_.cell_m;
    double length_m = 0;
    while (length_m < max_m && labelAt(grid_, labels_, from + (length_m + step_m) * direction) == label)
      length_m += step_m;
    return length_m;
  }
  double acrossAt(const Eigen::Vector2d& p, const Eigen::Vector2d& axis, int32_t label) const {
    const Eigen::Vector2d side(-axis.y(), axis.x());
    if (labelAt(grid_, labels_, p) != label) return 0;
    return reach(p, side, label, kMaxRay_m) + reach(p, -side, label, kMaxRay_m);
  }
  bool obstacleNear(const Eigen::Vector2d& p) const {
    const CellStep at = cellAt(grid_, p);
    for (int y = at.y - 1; y <= at.y + 1; ++y)
      for (int x = at.x - 1; x <= at.x + 1; ++x)
        if (stateAt(grid_, x, y) == CellState::kObstacle) return true;
    return false;
  }

  // Long, and as wide as its mouth for the most part of that length.
  bool isArm(const Eigen::Vector2d& start, double cut_m, double width_m, const Candidate& at,
             int32_t label) const {
    const double length_m = std::max(kMinArm_m, config_.corridor_aspect * width_m);
    std::array<double, 3> lengths{};
    for (size_t k = 0; k < 3; ++k)
      lengths[k] =
          reach(start + 0.25 * static_cast<double>(k + 1) * cut_m * at.along, at.arm, label, length_m);
    std::sort(lengths.begin(), lengths.end());
    if (lengths[1] < length_m - grid_.cell_m) return false;
    const Eigen::Vector2d middle = start + 0.5 * cut_m * at.along;
    std::array<double, 8> widths{};
    for (size_t k = 0; k < widths.size(); ++k)
      widths[k] = acrossAt(middle + (static_cast<double>(k) + 0.5) / 8 * length_m * at.arm, at.arm, label);
    std::sort(widths.begin(), widths.end());
    return widths[4] <= kSameWidth * width_m;
  }

  // Length, in the direction of the cut, of what lies beyond the cut.
  double besideLength(const Eigen::Vector2d& middle, double width_m, const Candidate& at,
                      int32_t label) const {
    double longest_m = 0;
    for (const double depth : {0.25, 0.5, 0.75}) {
      const Eigen::Vector2d p = middle - depth * width_m * at.arm;
      if (labelAt(grid_, labels_, p) != label) break;
      longest_m =
          std::max(longest_m, reach(p, at.along, label, kMaxRay_m) + reach(p, -at.along, label, kMaxRay_m));
    }
    return longest_m;
  }

  // Length of arm and continuation, if the arm goes straight on beyond the cut for more than what an arm
  // beside it may be wide; else 0.
  double straightLength(const Eigen::Vector2d& middle, double width_m, const Candidate& at,
                        int32_t label) const {
    const double onward_m = reach(middle, -at.arm, label, kMaxRay_m);
    std::array<double, 6> widths{};
    for (size_t k = 0; k < widths.size(); ++k)
      widths[k] = acrossAt(middle - (0.4 + 0.6 * (static_cast<double>(k) + 0.5) / 6) * onward_m * at.arm,
                           at.arm, label);
    std::sort(widths.begin(), widths.end());
    if (onward_m < 2 * width_m || widths[3] > kSameWidth * width_m) return 0;
    return onward_m + reach(middle, at.arm, label, kMaxRay_m);
  }

  static constexpr double kMaxRay_m = 60;
  const StoreyGrid& grid_;
  const FreeSpaceGraphConfig& config_;
  const CellLabels& labels_;
};

// Takes the cells of a cut out of their region. A line of cells that meet at their sides: neither a path of
// cells nor a ray slips through.
void block(const StoreyGrid& grid, const Cut& cut, CellLabels& labels, std::vector<size_t>& taken) {
  const auto take = [&](int x, int y) {
    if (!grid.contains(x, y) || labels[grid.index(x, y)] == kNoLabel) return;
    labels[grid.index(x, y)] = kNoLabel;
    taken.push_back(grid.index(x, y));
  };
  const Eigen::Vector2d along = (cut.right - cut.left).normalized();
  CellStep last = cellAt(grid, cut.left);
  for (double s_m = 0; s_m < cut.width() + 0.5 * grid.cell_m; s_m += 0.25 * grid.cell_m) {
    const CellStep cell = cellAt(grid, cut.left + s_m * along);
    if (cell.x != last.x && cell.y != last.y) take(cell.x, last.y);
    take(cell.x, cell.y);
    last = cell;
  }
}

// Cells of the cuts go to a region beside them.
void giveBack(const StoreyGrid& grid, const std::vector<size_t>& taken, CellLabels& labels) {
  for (bool changed = true; changed;) {
    changed = false;
    for (const size_t cell : taken) {
      for (size_t k = 0; k < 4 && labels[cell] == kNoLabel; ++k) {
        const int x = cellX(grid, cell) + kCellSteps[k].x, y = cellY(grid, cell) + kCellSteps[k].y;
        if (!grid.contains(x, y) || labels[grid.index(x, y)] == kNoLabel) continue;
        labels[cell] = labels[grid.index(x, y)];
        changed = true;
      }
    }
  }
}

std::vector<Candidate> candidatesOf(const StoreyGrid& grid, const Regions& regions) {
  std::vector<double> area_m2(static_cast<size_t>(regions.count), 0);
  for (const int32_t label : regions.labels)
    if (label != kNoLabel) area_m2[static_cast<size_t>(label)] += grid.cell_m * grid.cell_m;
  std::vector<Candidate> candidates;
  for (const CellLoop& loop : loopsOf(grid, regions.labels)) {
    // What stands free in a room is furniture; the core of a ring is larger than the ring.
    const double size_m2 = area_m2[static_cast<size_t>(loop.label)];
    if (loop.area_m2 < 0 && -loop.area_m2 < 0.5 * size_m2) continue;
    addCandidates(loop, grid.cell_m, candidates);
  }
  return candidates;
}

}  // namespace

std::vector<Cut> cutCorridorArms(const StoreyGrid& grid, const FreeSpaceGraphConfig& config,
                                 Regions& regions) {
  const ArmFinder finder(grid, config, regions.labels);
  std::vector<std::pair<Arm, Candidate>> arms;
  for (const Candidate& candidate : candidatesOf(grid, regions))
    if (const auto arm = finder.find(candidate)) arms.emplace_back(*arm, candidate);
  // What ends at its cut comes first: at a branch the branch, not what runs through. Then what is cut off
  // from the longest.
  std::stable_sort(arms.begin(), arms.end(), [](const auto& a, const auto& b) {
    if (a.first.goes_on != b.first.goes_on) return b.first.goes_on;
    return a.first.beside_m > b.first.beside_m;
  });
  std::vector<Cut> cuts;
  std::vector<size_t> taken;
  for (const auto& [first_look, candidate] : arms) {
    const auto arm = finder.find(candidate);  // on what the cuts so far have left
    if (!arm) continue;
    cuts.push_back(arm->cut);
    block(grid, arm->cut, regions.labels, taken);
  }
  if (cuts.empty()) return cuts;
  splitIntoPieces(grid, regions);
  giveBack(grid, taken, regions.labels);
  return cuts;
}

}  // namespace sgraphs
