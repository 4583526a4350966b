#include "tests/perception/rooms/free_cells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "perception/rooms/simple_polygon.h"

namespace sgraphs::test {
namespace {

using simulate::Room;
using simulate::Scene;

constexpr double kSkin_m = 0.05;  // obstacles of the grid are as much thicker

struct Opening {
  Eigen::Vector2d middle;
  Doorframe frame;
  double width_m;
};

class Cells {
 public:
  Cells(const Scene& scene, const Room& room, double cell_m, const Eigen::Rotation2Dd& rotation,
        const Eigen::Vector2d& offset_m)
      : scene_(scene), room_(room), cell_m_(cell_m), rotation_(rotation), offset_m_(offset_m) {
    for (const simulate::Doorway& door : scene.doorways)
      if (door.floor == room.floor)
        doors_.push_back({door.xyz.head<2>(), doorframeOf(scene, door), door.width_m});
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& p : room.polygon) box.extend(Eigen::Vector2d(rotation * p + offset_m));
    x0_ = static_cast<int>(std::floor(box.min().x() / cell_m)) - 5;
    y0_ = static_cast<int>(std::floor(box.min().y() / cell_m)) - 5;
    width_ = static_cast<int>(std::ceil(box.max().x() / cell_m)) + 5 - x0_;
    height_ = static_cast<int>(std::ceil(box.max().y() / cell_m)) + 5 - y0_;
    free_.resize(static_cast<size_t>(width_ * height_));
    for (int y = 1; y < height_ - 1; ++y)
      for (int x = 1; x < width_ - 1; ++x) free_[index(x, y)] = isFree(buildingAt(x + 0.5, y + 0.5));
    keepLargest();
  }

  FreeSpaceCluster cluster() const {
    FreeSpaceCluster cluster;
    cluster.border = border();
    const double cells = static_cast<double>(std::count(free_.begin(), free_.end(), true));
    cluster.area_m2 = static_cast<float>(cells * cell_m_ * cell_m_);
    return cluster;
  }

 private:
  using Lattice = std::pair<int, int>;

  size_t index(int x, int y) const { return static_cast<size_t>(y * width_ + x); }
  Eigen::Vector2d mapAt(double x, double y) const { return cell_m_ * Eigen::Vector2d(x + x0_, y + y0_); }
  Eigen::Vector2d buildingAt(double x, double y) const {
    return rotation_.inverse() * Eigen::Vector2d(mapAt(x, y) - offset_m_);
  }

  bool isFurnished(const Eigen::Vector2d& p) const {
    const double z = scene_.floors_z_m[static_cast<size_t>(room_.floor)];
    for (const simulate::Box& box : scene_.boxes) {
      if (box.z_max_m < z + 0.3 || box.z_min_m > z + 1.5) continue;
      const Eigen::Vector2d q = Eigen::Rotation2Dd(-box.yaw_rad) * Eigen::Vector2d(p - box.center);
      if (std::abs(q.x()) < 0.5 * box.size.x() + kSkin_m && std::abs(q.y()) < 0.5 * box.size.y() + kSkin_m)
        return true;
    }
    return std::any_of(scene_.columns.begin(), scene_.columns.end(), [&](const simulate::Column& column) {
      return (p - column.center).norm() < column.radius_m + kSkin_m;
    });
  }

  bool isFree(const Eigen::Vector2d& p) const {
    if (isFurnished(p)) return false;
    for (const Opening& door : doors_) {
      const Eigen::Vector2d q = p - door.middle;
      if (std::abs(door.frame.along.dot(q)) > 0.5 * door.width_m - kSkin_m) continue;
      // This room's side of the middle of the wall.
      const Eigen::Vector2d n = door.frame.normal, reach = (0.5 * door.frame.thickness_m + 0.15) * n;
      const double off = n.dot(q);
      if (std::abs(off) > 0.5 * door.frame.thickness_m + 2 * kSkin_m) continue;
      if (off >= 0 && contains(room_.polygon, door.middle + reach)) return true;
      if (off <= 0 && contains(room_.polygon, door.middle - reach)) return true;
    }
    if (!contains(room_.polygon, p)) return false;
    for (size_t i = 0; i < room_.polygon.size(); ++i)
      if (distanceToSegment(p, room_.polygon[i], room_.polygon[(i + 1) % room_.polygon.size()]) < kSkin_m)
        return false;
    return true;
  }

  void keepLargest() {
    std::vector<int> part(free_.size(), -1);
    std::vector<size_t> sizes;
    for (size_t seed = 0; seed < free_.size(); ++seed) {
      if (!free_[seed] || part[seed] >= 0) continue;
      std::vector<size_t> open{seed};
      part[seed] = static_cast<int>(sizes.size());
      sizes.push_back(0);
      while (!open.empty()) {
        const size_t i = open.back();
        open.pop_back();
        ++sizes.back();
        const size_t w = static_cast<size_t>(width_);
        for (const size_t next : {i - 1, i + 1, i - w, i + w})
          if (free_[next] && part[next] < 0) {
            part[next] = part[seed];
            open.push_back(next);
          }
      }
    }
    const auto largest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
    for (size_t i = 0; i < free_.size(); ++i) free_[i] = free_[i] && part[i] == largest;
  }

  BorderKind kindAt(const Eigen::Vector2d& p) const {
    for (const Opening& door : doors_)
      if (std::abs(door.frame.along.dot(p - door.middle)) < 0.5 * door.width_m - kSkin_m &&
          std::abs(door.frame.normal.dot(p - door.middle)) < 0.12)
        return BorderKind::kPassage;
    // An open edge of the plan's room leads into the next one.
    for (const Room& other : scene_.rooms)
      if (other.id != room_.id && other.floor == room_.floor && distanceTo(other.polygon, p) < 0.08)
        return BorderKind::kPassage;
    return BorderKind::kObstacle;
  }

  // Each side of a free cell without a free cell beyond, the free one on its left.
  std::map<Lattice, std::vector<Lattice>> sides() const {
    std::map<Lattice, std::vector<Lattice>> sides;
    for (int y = 1; y < height_ - 1; ++y)
      for (int x = 1; x < width_ - 1; ++x) {
        if (!free_[index(x, y)]) continue;
        if (!free_[index(x, y - 1)]) sides[{x, y}].push_back({x + 1, y});
        if (!free_[index(x + 1, y)]) sides[{x + 1, y}].push_back({x + 1, y + 1});
        if (!free_[index(x, y + 1)]) sides[{x + 1, y + 1}].push_back({x, y + 1});
        if (!free_[index(x - 1, y)]) sides[{x, y + 1}].push_back({x, y});
      }
    return sides;
  }

  std::vector<BorderCorner> border() const {
    std::map<Lattice, std::vector<Lattice>> open = sides();
    std::vector<Lattice> best;
    double most = 0;
    while (!open.empty()) {
      std::vector<Lattice> loop{open.begin()->first};
      double twice = 0;
      do {
        const Lattice at = loop.back();
        std::vector<Lattice>& next = open[at];
        // Where two cells touch in a corner: turn left, to stay at this one.
        size_t choice = 0;
        if (next.size() == 2 && loop.size() > 1) {
          const Lattice from = loop[loop.size() - 2];
          const int dx = at.first - from.first, dy = at.second - from.second;
          if (dx * (next[1].second - at.second) - dy * (next[1].first - at.first) > 0) choice = 1;
        }
        const Lattice to = next[choice];
        next.erase(next.begin() + static_cast<std::ptrdiff_t>(choice));
        if (next.empty()) open.erase(at);
        twice += at.first * to.second - at.second * to.first;
        loop.push_back(to);
      } while (loop.back() != loop.front());
      loop.pop_back();
      if (twice <= most) continue;
      most = twice;
      best = loop;
    }
    return cornersOf(best);
  }

  std::vector<BorderCorner> cornersOf(const std::vector<Lattice>& loop) const {
    std::vector<BorderCorner> corners;
    const size_t n = loop.size();
    std::vector<BorderKind> kinds(n);
    for (size_t i = 0; i < n; ++i) {
      const Lattice &a = loop[i], &b = loop[(i + 1) % n];
      kinds[i] = kindAt(buildingAt(0.5 * (a.first + b.first), 0.5 * (a.second + b.second)));
    }
    for (size_t i = 0; i < n; ++i) {
      const Lattice &before = loop[(i + n - 1) % n], &at = loop[i], &after = loop[(i + 1) % n];
      const bool straight = at.first - before.first == after.first - at.first &&
                            at.second - before.second == after.second - at.second;
      if (straight && kinds[i] == kinds[(i + n - 1) % n]) continue;
      corners.push_back({mapAt(at.first, at.second).cast<float>(), kinds[i]});
    }
    return corners;
  }

  const Scene& scene_;
  const Room& room_;
  double cell_m_;
  Eigen::Rotation2Dd rotation_;
  Eigen::Vector2d offset_m_;
  std::vector<Opening> doors_;
  int x0_ = 0, y0_ = 0, width_ = 0, height_ = 0;
  std::vector<bool> free_;
};

}  // namespace

Doorframe doorframeOf(const Scene& scene, const simulate::Doorway& door) {
  Doorframe frame;
  double least = 0.5;
  for (const simulate::Wall& wall : scene.walls) {
    const double off = distanceToSegment(door.xyz.head<2>(), wall.a, wall.b);
    if (off >= least) continue;
    least = off;
    frame.along = (wall.b - wall.a).normalized();
    frame.normal = {-frame.along.y(), frame.along.x()};
    frame.thickness_m = wall.thickness_m;
  }
  return frame;
}

FreeSpaceCluster freeCellsOf(const Scene& scene, const Room& room, double cell_m,
                             const Eigen::Rotation2Dd& rotation, const Eigen::Vector2d& offset_m) {
  return Cells(scene, room, cell_m, rotation, offset_m).cluster();
}

}  // namespace sgraphs::test
