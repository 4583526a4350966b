#include "perception/free_space/clusters/corridor_arms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/geometry/convex_polygon.h"
#include "perception/free_space/clusters/cell_rays.h"
#include "perception/free_space/clusters/region_border.h"
#include "perception/free_space/clusters/region_cuts.h"

namespace sgraphs {
namespace {

constexpr double kMinWall_m = 1.0;    // a shorter piece of wall has no direction on the grid
constexpr double kMaxCorner_m = 1.0;  // how far corners are rounded, by pieces too short for a direction
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

// Pieces of a loop that are walls, in turn: first and last corner, modulo the loop's size.
std::vector<std::pair<size_t, size_t>> wallsOf(const CellLoop& loop, double tolerance_m) {
  const std::vector<size_t> stay = simplifiedLoop(loop, {}, tolerance_m);
  std::vector<std::pair<size_t, size_t>> walls;
  for (size_t k = 0; k < stay.size(); ++k) {
    const size_t end = k + 1 < stay.size() ? stay[k + 1] : stay[0] + loop.corners.size();
    if (isWall(loop, stay[k], end, kMinWall_m)) walls.emplace_back(stay[k], end);
  }
  return walls;
}

void addCandidates(const CellLoop& loop, double cell_m, double tolerance_m,
                   std::vector<Candidate>& candidates) {
  const auto walls = wallsOf(loop, tolerance_m);
  const auto at = [&loop](size_t i) -> const Eigen::Vector2d& {
    return loop.corners[i % loop.corners.size()];
  };
  for (size_t k = 0; k < walls.size(); ++k) {
    const auto [in_begin, in_end] = walls[k];
    const auto [out_begin, out_end] = walls[(k + 1) % walls.size()];
    const Eigen::Vector2d &last = at(in_end), &first = at(out_begin);
    if ((first - last).norm() > kMaxCorner_m) continue;
    const Eigen::Vector2d in_chord = (last - at(in_begin)).normalized();
    if (cross(in_chord, (at(out_end) - first).normalized()) > -0.5 * kMinTurn) continue;
    const BorderLine in = lineOf(loop, in_begin, in_end, cell_m),
                     out = lineOf(loop, out_begin, out_end, cell_m);
    const double turn = cross(in.direction, out.direction);
    if (turn > -kMinTurn) continue;
    // Where the lines of the walls meet: noise takes the loop's own corner off.
    const Eigen::Vector2d corner =
        in.point + cross(out.point - in.point, out.direction) / turn * in.direction;
    if ((corner - 0.5 * (first + last)).norm() > kMaxCorner_m) continue;
    const bool is_known = std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& other) {
      return (other.corner - corner).norm() < kMaxCorner_m && other.along.dot(in.direction) > 0.98;
    });
    if (is_known) continue;
    candidates.push_back({loop.label, corner, in.direction, out.direction});
    candidates.push_back({loop.label, corner, -out.direction, -in.direction});
  }
}

// Looks at one candidate on the regions as they are now.
class ArmFinder {
 public:
  ArmFinder(const StoreyGrid& grid, const FreeSpaceGraphConfig& config, const CellLabels& labels)
      : grid_(grid), config_(config), labels_(labels) {}

  std::optional<Arm> find(const Candidate& at) const {
    Eigen::Vector2d start = at.corner + 0.5 * grid_.cell_m * (at.along + at.arm);
    for (int k = 0; k < 4 && labelAt(grid_, labels_, start) == kNoLabel; ++k)
      start += 0.5 * grid_.cell_m * at.along;
    const int32_t label = labelAt(grid_, labels_, start);
    if (label == kNoLabel) return std::nullopt;
    const double cut_m = reachWithin(grid_, labels_, start, at.along, label, kMaxArmWidth_m * 1.5);
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
  double acrossAt(const Eigen::Vector2d& p, const Eigen::Vector2d& axis, int32_t label) const {
    const Eigen::Vector2d side(-axis.y(), axis.x());
    if (labelAt(grid_, labels_, p) != label) return 0;
    return reachWithin(grid_, labels_, p, side, label, kMaxRay_m) +
           reachWithin(grid_, labels_, p, -side, label, kMaxRay_m);
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
      lengths[k] = reachWithin(grid_, labels_, start + 0.25 * static_cast<double>(k + 1) * cut_m * at.along,
                               at.arm, label, length_m);
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
    // Along a corridor of 50 m a ray must not end at a wall that the grid bends by a degree, or at one cell.
    constexpr double kAngles_rad[] = {-0.02, -0.01, 0, 0.01, 0.02};
    double longest_m = 0;
    for (const double depth : {0.25, 0.4, 0.5, 0.6, 0.75}) {
      const Eigen::Vector2d p = middle - depth * width_m * at.arm;
      if (labelAt(grid_, labels_, p) != label) break;
      double forward_m = 0, back_m = 0;
      for (const double angle_rad : kAngles_rad) {
        const Eigen::Vector2d along = at.along + angle_rad * at.arm;
        forward_m = std::max(forward_m, reachWithin(grid_, labels_, p, along, label, kMaxRay_m));
        back_m = std::max(back_m, reachWithin(grid_, labels_, p, -along, label, kMaxRay_m));
      }
      longest_m = std::max(longest_m, forward_m + back_m);
    }
    return longest_m;
  }

  // Length of arm and continuation, if the arm goes straight on beyond the cut for more than what an arm
  // beside it may be wide; else 0.
  double straightLength(const Eigen::Vector2d& middle, double width_m, const Candidate& at,
                        int32_t label) const {
    const double onward_m = reachWithin(grid_, labels_, middle, -at.arm, label, kMaxRay_m);
    std::array<double, 6> widths{};
    for (size_t k = 0; k < widths.size(); ++k)
      widths[k] = acrossAt(middle - (0.4 + 0.6 * (static_cast<double>(k) + 0.5) / 6) * onward_m * at.arm,
                           at.arm, label);
    std::sort(widths.begin(), widths.end());
    if (onward_m < 2 * width_m || widths[3] > kSameWidth * width_m) return 0;
    return onward_m + reachWithin(grid_, labels_, middle, at.arm, label, kMaxRay_m);
  }

  static constexpr double kMaxRay_m = 60;
  const StoreyGrid& grid_;
  const FreeSpaceGraphConfig& config_;
  const CellLabels& labels_;
};

std::vector<Candidate> candidatesOf(const StoreyGrid& grid, const Regions& regions) {
  std::vector<double> area_m2(static_cast<size_t>(regions.count), 0);
  for (const int32_t label : regions.labels)
    if (label != kNoLabel) area_m2[static_cast<size_t>(label)] += grid.cell_m * grid.cell_m;
  std::vector<Candidate> candidates;
  for (const CellLoop& loop : loopsOf(grid, regions.labels)) {
    // What stands free in a room is furniture; the core of a ring is larger than the ring.
    const double size_m2 = area_m2[static_cast<size_t>(loop.label)];
    if (loop.area_m2 < 0 && -loop.area_m2 < 0.5 * size_m2) continue;
    // What noise breaks into pieces at one tolerance is straight at another.
    for (const double tolerance : {2.2, 3.3})
      addCandidates(loop, grid.cell_m, tolerance * grid.cell_m, candidates);
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
  RegionCutter cutter(grid, regions);
  for (const auto& [first_look, candidate] : arms) {
    const auto arm = finder.find(candidate);  // on what the cuts so far have left
    if (!arm) continue;
    cuts.push_back(arm->cut);
    cutter.cut(arm->cut);
  }
  cutter.finish();
  return cuts;
}

}  // namespace sgraphs
