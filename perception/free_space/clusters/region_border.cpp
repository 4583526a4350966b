#include "perception/free_space/clusters/region_border.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/convex_polygon.h"
#include "common/geometry/simplify_chain.h"

namespace sgraphs {
namespace {

// Directions east, north, west, south. A corner (x, y) is the lower left one of cell (x, y); beside the way
// from it in a direction lie a cell on the left and one on the right.
constexpr std::array<CellStep, 4> kStep{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
constexpr std::array<CellStep, 4> kLeft{{{0, 0}, {-1, 0}, {-1, -1}, {0, -1}}};
constexpr std::array<CellStep, 4> kRight{{{0, -1}, {0, 0}, {-1, 0}, {-1, -1}}};

class Tracer {
 public:
  Tracer(const StoreyGrid& grid, const CellLabels& labels)
      : grid_(grid), labels_(labels), seen_(labels.size(), 0) {}

  std::vector<CellLoop> run() {
    std::vector<CellLoop> loops;
    for (int y = 0; y < grid_.height; ++y)
      for (int x = 0; x < grid_.width; ++x) {
        const size_t i = grid_.index(x, y);
        if (labels_[i] != kNoLabel && !seen_[i] && label(x, y - 1) != labels_[i])
          loops.push_back(trace(x, y));
      }
    return loops;
  }

 private:
  int32_t label(int x, int y) const { return grid_.contains(x, y) ? labels_[grid_.index(x, y)] : kNoLabel; }

  BorderKind kindOf(int x, int y) const {
    if (label(x, y) != kNoLabel) return BorderKind::kPassage;
    return stateAt(grid_, x, y) == CellState::kObstacle ? BorderKind::kObstacle : BorderKind::kFrontier;
  }

  // Every loop has a side that runs east, below one of its cells: those are marked.
  CellLoop trace(int start_x, int start_y) {
    CellLoop loop;
    loop.label = label(start_x, start_y);
    int x = start_x, y = start_y;
    size_t direction = 0;
    do {
      if (direction == 0) seen_[grid_.index(x, y)] = 1;
      loop.corners.push_back(grid_.origin_map + grid_.cell_m * Eigen::Vector2d(x, y));
      loop.kinds.push_back(kindOf(x + kRight[direction].x, y + kRight[direction].y));
      x += kStep[direction].x;
      y += kStep[direction].y;
      // Where two of its cells meet at a corner only, a loop turns left: regions are connected by sides.
      const bool left = label(x + kLeft[direction].x, y + kLeft[direction].y) == loop.label;
      const bool right = label(x + kRight[direction].x, y + kRight[direction].y) == loop.label;
      if (!left) direction = (direction + 1) % 4;
      if (left && right) direction = (direction + 3) % 4;
    } while (x != start_x || y != start_y || direction != 0);
    loop.area_m2 = polygonArea(loop.corners);
    return loop;
  }

  const StoreyGrid& grid_;
  const CellLabels& labels_;
  std::vector<uint8_t> seen_;
};

bool touch(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
           const Eigen::Vector2d& d) {
  if (std::max(a.x(), b.x()) < std::min(c.x(), d.x()) || std::max(c.x(), d.x()) < std::min(a.x(), b.x()) ||
      std::max(a.y(), b.y()) < std::min(c.y(), d.y()) || std::max(c.y(), d.y()) < std::min(a.y(), b.y()))
    return false;
  return cross(b - a, c - a) * cross(b - a, d - a) <= 0 && cross(d - c, a - c) * cross(d - c, b - c) <= 0;
}

bool isSimpleLoop(const CellLoop& loop, const std::vector<size_t>& stay) {
  const size_t n = stay.size();
  if (n < 3) return false;
  const auto p = [&](size_t i) -> const Eigen::Vector2d& { return loop.corners[stay[i % n]]; };
  for (size_t i = 0; i < n; ++i)
    for (size_t j = i + 2; j < n; ++j)
      if (!(i == 0 && j + 1 == n) && touch(p(i), p(i + 1), p(j), p(j + 1))) return false;
  return true;
}

// Runs of a kind shorter than three sides are noise: they become what is before them.
std::vector<BorderKind> smoothed(const std::vector<BorderKind>& kinds) {
  const size_t n = kinds.size();
  std::vector<BorderKind> result = kinds;
  size_t start = 0;
  while (start < n && kinds[start] == kinds[(start + n - 1) % n]) ++start;
  if (start == n) return result;
  for (size_t i = start; i < start + n;) {
    size_t end = i;
    while (end < start + n && kinds[end % n] == kinds[i % n]) ++end;
    if (end - i < 3 && kinds[i % n] != BorderKind::kPassage)
      for (size_t k = i; k < end; ++k) result[k % n] = result[(i + n - 1) % n];
    i = end;
  }
  return result;
}

// The finest drawing with few enough corners that does not cross itself. Half a cell more than a cell's
// staircase first; up to a metre, beyond which a border says nothing any more.
std::vector<size_t> drawnSimply(const CellLoop& loop, const std::vector<size_t>& fixed, double cell_m,
                                size_t max_corners) {
  std::vector<size_t> stay;
  for (double tolerance_m = 0.75 * cell_m; tolerance_m < 1.0; tolerance_m *= 1.4) {
    // Corners where the kind changes are worth less than a border that is simple.
    for (const auto& corners : {fixed, std::vector<size_t>{}}) {
      stay = simplifiedLoop(loop, corners, tolerance_m);
      if (stay.size() <= max_corners && isSimpleLoop(loop, stay)) return stay;
    }
  }
  return stay;
}

// Least squares; the direction is the one of the two that is nearer to `hint`.
BorderLine lineThrough(const std::vector<Eigen::Vector2d>& points, const Eigen::Vector2d& hint) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& p : points) spread += (p - mean) * (p - mean).transpose();
  const double angle_rad = 0.5 * std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1));
  const Eigen::Vector2d axis(std::cos(angle_rad), std::sin(angle_rad));
  return {mean, axis.dot(hint) < 0 ? Eigen::Vector2d(-axis) : axis};
}

}  // namespace

std::vector<CellLoop> loopsOf(const StoreyGrid& grid, const CellLabels& labels) {
  return Tracer(grid, labels).run();
}

std::vector<size_t> simplifiedLoop(const CellLoop& loop, const std::vector<size_t>& fixed,
                                   double tolerance_m) {
  const size_t n = loop.corners.size();
  std::vector<uint8_t> stays(n, 0);
  for (const size_t i : fixed) stays[i] = 1;
  // Two corners that stay in any case: the ends of the loop in one direction.
  const auto by_x = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  };
  const auto ends = std::minmax_element(loop.corners.begin(), loop.corners.end(), by_x);
  stays[static_cast<size_t>(ends.first - loop.corners.begin())] = 1;
  stays[static_cast<size_t>(ends.second - loop.corners.begin())] = 1;
  const auto listed = [&stays, n] {
    std::vector<size_t> list;
    for (size_t i = 0; i < n; ++i)
      if (stays[i]) list.push_back(i);
    return list;
  };
  const std::vector<size_t> anchors = listed();
  for (size_t k = 0; k < anchors.size(); ++k) {
    const size_t next = k + 1 < anchors.size() ? anchors[k + 1] : anchors.front() + n;
    simplifyChain(loop.corners, anchors[k], next, tolerance_m, stays);
  }
  return listed();
}

BorderLine lineOf(const CellLoop& loop, size_t begin, size_t end, double cell_m) {
  constexpr size_t kReach = 40;  // sides: noise of a cell turns shorter pieces by several degrees
  const size_t n = loop.corners.size(), more = end - begin < kReach ? (kReach - (end - begin)) / 2 : 0;
  std::vector<Eigen::Vector2d> corners;
  for (size_t i = begin + n - std::min(more, n); i <= end + n + more; ++i)
    corners.push_back(loop.corners[i % n]);
  const Eigen::Vector2d from = loop.corners[begin % n], to = loop.corners[end % n];
  const Eigen::Vector2d chord = (to - from).normalized(), middle = 0.5 * (from + to);
  // The direction near the chord's that has most corners in one strip of a cell's width.
  size_t best_count = 0;
  double best_offset_m = 0;
  Eigen::Vector2d best = chord;
  for (int degrees = -24; degrees <= 24; degrees += 2) {
    const double angle_rad = degrees * M_PI / 180;
    const Eigen::Vector2d axis =
        std::cos(angle_rad) * chord + std::sin(angle_rad) * Eigen::Vector2d(-chord.y(), chord.x());
    std::array<size_t, 40> bins{};
    const double bin_m = 0.5 * cell_m;
    for (const Eigen::Vector2d& p : corners) {
      const double bin = std::floor(cross(axis, p - middle) / bin_m) + 20;
      if (bin >= 0 && bin < 40) ++bins[static_cast<size_t>(bin)];
    }
    for (size_t k = 0; k + 2 < bins.size(); ++k)
      if (bins[k] + bins[k + 1] + bins[k + 2] > best_count) {
        best_count = bins[k] + bins[k + 1] + bins[k + 2];
        best_offset_m = (static_cast<double>(k) - 20 + 1.5) * bin_m;
        best = axis;
      }
  }
  std::vector<Eigen::Vector2d> near;
  for (const Eigen::Vector2d& p : corners)
    if (std::abs(cross(best, p - middle) - best_offset_m) < cell_m) near.push_back(p);
  return lineThrough(near, best);
}

bool isWall(const CellLoop& loop, size_t begin, size_t end, double min_length_m) {
  const size_t n = loop.corners.size();
  size_t obstacles = 0;
  for (size_t i = begin; i < end; ++i) obstacles += loop.kinds[i % n] == BorderKind::kObstacle ? 1 : 0;
  return 2 * obstacles > end - begin &&
         (loop.corners[end % n] - loop.corners[begin % n]).norm() >= min_length_m;
}

std::vector<BorderCorner> borderOf(const CellLoop& loop, double cell_m, size_t max_corners) {
  const size_t n = loop.corners.size();
  if (n == 0) return {};
  const std::vector<BorderKind> kinds = smoothed(loop.kinds);
  std::vector<size_t> changes;
  for (size_t i = 0; i < n; ++i)
    if (kinds[i] != kinds[(i + n - 1) % n]) changes.push_back(i);
  if (changes.size() > max_corners / 2) changes.clear();
  const std::vector<size_t> stay = drawnSimply(loop, changes, cell_m, max_corners);
  std::vector<BorderCorner> border;
  for (size_t k = 0; k < stay.size(); ++k) {
    const size_t end = k + 1 < stay.size() ? stay[k + 1] : stay.front() + n;
    std::array<size_t, 3> votes{};
    for (size_t i = stay[k]; i < end; ++i) ++votes[static_cast<size_t>(kinds[i % n])];
    const auto kind = static_cast<size_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
    border.push_back({loop.corners[stay[k]].cast<float>(), static_cast<BorderKind>(kind)});
  }
  return border;
}

}  // namespace sgraphs
