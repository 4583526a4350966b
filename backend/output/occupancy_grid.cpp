#include "backend/output/occupancy_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "backend/output/floor_level.h"

namespace sgraphs {
namespace {

constexpr double kBandLow_m = 0.3;
constexpr double kBandHigh_m = 1.8;
// Log-odds per keyframe and their limits, as usual for occupancy maps (p = 0.7 for a hit, 0.4 for a pass).
constexpr float kHit = 0.85f;
constexpr float kPass = -0.4f;
constexpr float kMin = -2.0f;
constexpr float kMax = 3.5f;
constexpr int kBeaten = 20;  // cells: 1 m

struct Ray {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
  bool ends_here = false;  // the return lies in the band
};

// The part of the ray inside the band, seen from above.
std::optional<Ray> clipToBand(const StoreyHeight& height, const Eigen::Vector3d& viewpoint,
                              const Eigen::Vector3d& point) {
  const double a = height.above(viewpoint), b = height.above(point);
  double begin = 0, end = 1;
  if (std::abs(b - a) > 1e-9) {
    const double s_low = (kBandLow_m - a) / (b - a), s_high = (kBandHigh_m - a) / (b - a);
    begin = std::max(begin, std::min(s_low, s_high));
    end = std::min(end, std::max(s_low, s_high));
  } else if (a < kBandLow_m || a > kBandHigh_m) {
    return std::nullopt;
  }
  if (begin >= end) return std::nullopt;
  const Eigen::Vector2d direction = (point - viewpoint).head<2>();
  const Eigen::Vector2d origin = viewpoint.head<2>();
  return Ray{origin + begin * direction, origin + end * direction, end == 1};
}

std::vector<Ray> raysOf(const KeyframeNode& node, const StoreyHeight& height) {
  std::vector<Ray> rays;
  if (!node.keyframe) return rays;
  std::vector<Eigen::Vector3d> viewpoints;
  for (const SE3& T_keyframe_body : node.keyframe->T_keyframe_body)
    viewpoints.push_back((node.T_map_body * T_keyframe_body * node.keyframe->T_body_lidar).translation);
  const Eigen::Matrix3d rotation = node.T_map_body.matrix3();
  for (const KeyframePoint& point : node.keyframe->points) {
    if (point.scan >= viewpoints.size()) continue;
    const Eigen::Vector3d p = rotation * point.position_body.cast<double>() + node.T_map_body.translation;
    if (const auto ray = clipToBand(height, viewpoints[point.scan], p)) rays.push_back(*ray);
  }
  return rays;
}

class GridBuilder {
 public:
  GridBuilder(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double resolution) {
    grid_.resolution_m = resolution;
    // Whole multiples of the resolution: storeys and runs of one map share their raster.
    const Eigen::Vector2d first = (low / resolution).array().floor() - 2;
    grid_.origin_map = first * resolution;
    const Eigen::Vector2d size = ((high - grid_.origin_map) / resolution).array().ceil() + 2;
    if (size.x() * size.y() > kMaxStoreyCells)
      return;  // an outlier kilometres away: no grid rather than no memory
    grid_.width = static_cast<int>(size.x());
    grid_.height = static_cast<int>(size.y());
    cells_.assign(static_cast<size_t>(grid_.width) * grid_.height, {});
  }

  void add(const std::vector<Ray>& rays) {
    if (cells_.empty()) return;
    ++keyframe_;
    for (const Ray& ray : rays)
      if (ray.ends_here) update(cellOf(ray.to), kHit);
    for (const Ray& ray : rays)
      if (isFirst(ray)) clear(ray);
  }

  OccupancyGrid finish() {
    grid_.cells.assign(cells_.size(), Occupancy::kUnknown);
    for (size_t i = 0; i < cells_.size(); ++i)
      if (cells_[i].touched > 0)
        grid_.cells[i] = cells_[i].log_odds > 0 ? Occupancy::kOccupied : Occupancy::kFree;
    return std::move(grid_);
  }

 private:
  struct Cell {
    float log_odds = 0;
    int32_t touched = 0;  // by which keyframe last, counted from 1
    int32_t cleared = 0;  // up to here, by which keyframe's ray last, and whether it ended here
  };

  Eigen::Vector2i cellOf(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d cell = (p - grid_.origin_map) / grid_.resolution_m;
    return cell.array().floor().cast<int>();
  }
  Cell& at(const Eigen::Vector2i& cell) {
    return cells_[static_cast<size_t>(cell.y()) * grid_.width + cell.x()];
  }

  // At most once per keyframe and cell; hits come first and win. False: this keyframe was here before.
  bool update(const Eigen::Vector2i& place, float change) {
    Cell& cell = at(place);
    if (cell.touched == keyframe_) return false;
    cell.touched = keyframe_;
    cell.log_odds = std::clamp(cell.log_odds + change, kMin, kMax);
    return true;
  }

  // Points above one another on a wall, or seen again by the keyframe's next scan some centimetres on: their
  // rays cross nearly the same cells, one of them is enough.
  bool isFirst(const Ray& ray) {
    int32_t& last = at(cellOf(ray.to)).cleared;
    const int32_t now = keyframe_ * 2 + ray.ends_here;
    if (last == now) return false;
    last = now;
    return true;
  }

  // Amanatides and Woo, "A fast voxel traversal algorithm for ray tracing": every cell between the ends,
  // without the last one if the return is in it. From the far end: rays run together towards the sensor, and
  // where the keyframe has cleared kBeaten cells in a row already it has cleared the rest, too.
  void clear(const Ray& ray) {
    Eigen::Vector2i cell = cellOf(ray.to);
    const Eigen::Vector2i last = cellOf(ray.from);
    const Eigen::Vector2d direction = ray.from - ray.to;
    Eigen::Vector2d next, step_length;
    Eigen::Vector2i step;
    for (int k = 0; k < 2; ++k) {
      step[k] = direction[k] > 0 ? 1 : -1;
      const double border = grid_.origin_map[k] + (cell[k] + (direction[k] > 0 ? 1 : 0)) * grid_.resolution_m;
      step_length[k] = direction[k] != 0 ? grid_.resolution_m / std::abs(direction[k]) : 1e300;
      next[k] = direction[k] != 0 ? (border - ray.to[k]) / direction[k] : 1e300;
    }
    if (!ray.ends_here) update(cell, kPass);
    int beaten = 0;
    for (int left = (last - cell).cwiseAbs().sum(); left > 0 && beaten < kBeaten; --left) {
      const int k = next.x() < next.y() ? 0 : 1;
      cell[k] += step[k];
      next[k] += step_length[k];
      if (cell.x() < 0 || cell.y() < 0 || cell.x() >= grid_.width || cell.y() >= grid_.height) return;
      beaten = update(cell, kPass) ? 0 : beaten + 1;
    }
  }

  OccupancyGrid grid_;
  std::vector<Cell> cells_;
  int32_t keyframe_ = 0;
};

}  // namespace

Occupancy OccupancyGrid::at(const Eigen::Vector2d& p_map) const {
  const Eigen::Vector2d cell = ((p_map - origin_map) / resolution_m).array().floor();
  if (cell.x() < 0 || cell.y() < 0 || cell.x() >= width || cell.y() >= height) return Occupancy::kUnknown;
  return cells[static_cast<size_t>(cell.y()) * width + static_cast<size_t>(cell.x())];
}

OccupancyGrid buildOccupancy(const SituationalGraph& graph, const FloorNode& floor, double resolution_m) {
  const StoreyHeight height(graph, floor);
  Eigen::Vector2d low = Eigen::Vector2d::Constant(INFINITY), high = -low;
  const auto for_each = [&](const auto& use) {
    for (const auto& [id, node] : graph.keyframes)
      if (floorOf(node) == floor.id) use(raysOf(node, height));
  };
  for_each([&](const std::vector<Ray>& rays) {
    for (const Ray& ray : rays) {
      low = low.cwiseMin(ray.from).cwiseMin(ray.to);
      high = high.cwiseMax(ray.from).cwiseMax(ray.to);
    }
  });
  if (!low.allFinite()) return {Eigen::Vector2d::Zero(), resolution_m, 0, 0, {}};
  GridBuilder builder(low, high, resolution_m);
  for_each([&](const std::vector<Ray>& rays) { builder.add(rays); });
  return builder.finish();
}

std::string occupancyPgm(const OccupancyGrid& grid) {
  std::string bytes = "P5\n" + std::to_string(grid.width) + " " + std::to_string(grid.height) + "\n255\n";
  for (int row = grid.height - 1; row >= 0; --row)
    for (int col = 0; col < grid.width; ++col) {
      const Occupancy cell = grid.cells[static_cast<size_t>(row) * grid.width + col];
      const int value = cell == Occupancy::kOccupied ? 0 : cell == Occupancy::kFree ? 254 : 205;
      bytes.push_back(static_cast<char>(value));
    }
  return bytes;
}

std::string occupancyYaml(const OccupancyGrid& grid, const std::string& image_name) {
  char text[256];
  std::snprintf(text, sizeof text,
                "image: %s\nmode: trinary\nresolution: %.6f\norigin: [%.6f, %.6f, 0.0]\nnegate: 0\n"
                "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
                image_name.c_str(), grid.resolution_m, grid.origin_map.x(), grid.origin_map.y());
  return text;
}

}  // namespace sgraphs
