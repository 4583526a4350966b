#include "perception/loops/wall_layout.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sgraphs {
namespace {

constexpr float kCell_m = 0.25F;
constexpr int kHeadings = 16;
constexpr float kHeading_rad = 2.0F * std::numbers::pi_v<float> / kHeadings;
constexpr double kCoarseStep_m = 0.5;
constexpr double kCoarseStep_rad = 0.0524;  // 3 degrees
constexpr size_t kCoarseWalls = 120;
constexpr double kFineStep_m = 0.125;
constexpr double kFineStep_rad = 0.0175;
constexpr int kFineSteps = 3;  // to either side
constexpr double kApart_m = 0.75;
constexpr double kApart_rad = 0.175;
constexpr size_t kMaxPeaks = 24;   // that are refined
constexpr double kFarBelow = 0.7;  // of the best score: no match
constexpr double kLeastScore = 0.35;

int headingOf(float rad) {
  const auto k = static_cast<int>(std::floor(rad / kHeading_rad + 0.5F));
  return ((k % kHeadings) + kHeadings) % kHeadings;
}

// The bits of a heading and of those beside it.
uint16_t bitsOf(int heading) {
  unsigned bits = 0;
  for (const int d : {-1, 0, 1}) bits |= 1U << ((heading + d + kHeadings) % kHeadings);
  return static_cast<uint16_t>(bits);
}

double angleBetween(double a, double b) {
  return std::abs(std::remainder(a - b, 2.0 * std::numbers::pi));
}

bool distinct(const LayoutMatch& a, const LayoutMatch& b) {
  return (a.position_map - b.position_map).norm() > kApart_m ||
         angleBetween(a.yaw_rad, b.yaw_rad) > kApart_rad;
}

// Best first; of those that are not distinct only the best.
std::vector<LayoutMatch> distinctOf(std::vector<LayoutMatch> matches, size_t max) {
  std::stable_sort(matches.begin(), matches.end(),
                   [](const LayoutMatch& a, const LayoutMatch& b) { return a.score > b.score; });
  std::vector<LayoutMatch> kept;
  for (const LayoutMatch& m : matches) {
    if (kept.size() >= max || (!kept.empty() && m.score < kFarBelow * kept.front().score)) break;
    if (std::all_of(kept.begin(), kept.end(), [&](const LayoutMatch& k) { return distinct(k, m); }))
      kept.push_back(m);
  }
  return kept;
}

std::vector<WallPoint> thinned(const std::vector<WallPoint>& walls, size_t max) {
  const size_t n = std::min(walls.size(), max);
  std::vector<WallPoint> out;
  for (size_t i = 0; i < n; ++i) out.push_back(walls[i * walls.size() / n]);
  return out;
}

// The query turned by one yaw.
struct Turned {
  Eigen::Vector2f position;
  int heading;
};
std::vector<Turned> turned(const std::vector<WallPoint>& query, double yaw_rad) {
  const auto c = static_cast<float>(std::cos(yaw_rad)), s = static_cast<float>(std::sin(yaw_rad));
  std::vector<Turned> out;
  out.reserve(query.size());
  for (const WallPoint& w : query)
    out.push_back({{c * w.position.x() - s * w.position.y(), s * w.position.x() + c * w.position.y()},
                   headingOf(w.heading_rad + static_cast<float>(yaw_rad))});
  return out;
}

// A grid about the centre, row by row.
std::vector<Eigen::Vector2d> discOf(const LayoutSearch& where) {
  const int steps = static_cast<int>(std::ceil(where.radius_m / kCoarseStep_m));
  std::vector<Eigen::Vector2d> out;
  for (int iy = -steps; iy <= steps; ++iy)
    for (int ix = -steps; ix <= steps; ++ix) {
      const Eigen::Vector2d d(ix * kCoarseStep_m, iy * kCoarseStep_m);
      if (d.norm() <= where.radius_m) out.emplace_back(where.centre_map + d);
    }
  return out;
}

}  // namespace

WallLayout::WallLayout(const Eigen::Vector2d& centre_map, double half_size_m)
    : origin_((centre_map.array() - half_size_m).cast<float>()),
      size_(static_cast<int>(std::ceil(2.0 * half_size_m / kCell_m)) + 1),
      cells_(static_cast<size_t>(size_) * static_cast<size_t>(size_)) {}

void WallLayout::add(const WallPoint& wall) {
  const auto x = static_cast<int>(std::floor((wall.position.x() - origin_.x()) / kCell_m));
  const auto y = static_cast<int>(std::floor((wall.position.y() - origin_.y()) / kCell_m));
  if (x < 1 || y < 1 || x >= size_ - 1 || y >= size_ - 1) return;
  const uint16_t bits = bitsOf(headingOf(wall.heading_rad));
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      Mask& mask = cells_[static_cast<size_t>((y + dy) * size_ + x + dx)];
      mask.near |= bits;
      if (dx == 0 && dy == 0) mask.exact |= bits;
    }
}

const WallLayout::Mask* WallLayout::at(float x_m, float y_m) const {
  const auto x = static_cast<int>(std::floor((x_m - origin_.x()) / kCell_m));
  const auto y = static_cast<int>(std::floor((y_m - origin_.y()) / kCell_m));
  if (x < 0 || y < 0 || x >= size_ || y >= size_) return nullptr;
  return &cells_[static_cast<size_t>(y * size_ + x)];
}

std::vector<LayoutMatch> WallLayout::search(const std::vector<WallPoint>& query,
                                            const LayoutSearch& where) const {
  if (query.empty()) return {};
  // Share of the walls that are met; less than `least` is told as 0.
  const auto score = [&](const std::vector<Turned>& walls, const Eigen::Vector2d& p, bool exact,
                         double least) {
    const Eigen::Vector2f t = p.cast<float>();
    const auto n = static_cast<double>(walls.size());
    int may_miss = static_cast<int>(n * (1.0 - least)) + 1;
    int hits = 0;
    for (const Turned& w : walls) {
      const Mask* mask = at(t.x() + w.position.x(), t.y() + w.position.y());
      const int hit = mask ? ((exact ? mask->exact : mask->near) >> w.heading) & 1 : 0;
      hits += hit;
      if (hit == 0 && --may_miss < 0) return 0.0;
    }
    return static_cast<double>(hits) / n;
  };
  const int turns = static_cast<int>(std::ceil(where.yaw_range_rad / kCoarseStep_rad));
  const std::vector<Eigen::Vector2d> positions =
      where.positions_map.empty() ? discOf(where) : where.positions_map;
  const std::vector<WallPoint> few = thinned(query, kCoarseWalls);
  std::vector<LayoutMatch> peaks;
  double least = kLeastScore;
  for (int k = -turns; k <= turns; ++k) {
    const double yaw = where.yaw_rad + k * kCoarseStep_rad;
    const std::vector<Turned> walls = turned(few, yaw);
    for (const Eigen::Vector2d& position : positions) {
      const double s = score(walls, position, false, least);
      if (s < least) continue;
      peaks.push_back({position, yaw, s});
      least = std::max(least, kFarBelow * s);
    }
  }
  std::vector<LayoutMatch> refined;
  for (const LayoutMatch& peak : distinctOf(std::move(peaks), kMaxPeaks)) {
    LayoutMatch best = peak;
    best.score = -1;
    for (int k = -kFineSteps; k <= kFineSteps; ++k) {
      const double yaw = peak.yaw_rad + k * kFineStep_rad;
      const std::vector<Turned> walls = turned(query, yaw);
      for (int iy = -kFineSteps; iy <= kFineSteps; ++iy)
        for (int ix = -kFineSteps; ix <= kFineSteps; ++ix) {
          const Eigen::Vector2d p = peak.position_map + kFineStep_m * Eigen::Vector2d(ix, iy);
          const double s = score(walls, p, true, 0);
          if (s > best.score) best = {p, yaw, s};
        }
    }
    refined.push_back(best);
  }
  return distinctOf(std::move(refined), static_cast<size_t>(where.max_matches));
}

}  // namespace sgraphs
