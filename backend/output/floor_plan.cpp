#include "backend/output/floor_plan.h"

#include <algorithm>
#include <cmath>

#include "backend/output/dense_trajectory.h"
#include "backend/output/floor_level.h"

namespace sgraphs {
namespace {

constexpr double kCell_m = 0.05;
constexpr int kGreys = 8;
constexpr int kLightestGrey = 225;
constexpr uint8_t kDarkestGrey = 35;
constexpr uint8_t kGreyBehindWalls = 165;  // points step back where walls are drawn
constexpr double kFullInk = 12;            // occupied voxels of the slice's column that print darkest
constexpr double kOutlierShare = 0.002;    // of the slice's points may lie outside the picture, on each side
constexpr double kPathStep_m = 0.05;

std::vector<Eigen::Vector2d> slicePoints(std::span<const MapPoint> map, FloorId floor,
                                         const StoreyHeight& height) {
  std::vector<Eigen::Vector2d> slice;
  for (const MapPoint& point : map) {
    if (point.floor != floor) continue;
    const Eigen::Vector3d p = point.position_map.cast<double>();
    const double h = height.above(p);
    if (h >= kPlanSliceLow_m && h <= kPlanSliceHigh_m) slice.emplace_back(p.head<2>());
  }
  return slice;
}

// Extent without the few points seen far away through a window.
Paper robustExtent(const std::vector<Eigen::Vector2d>& points,
                   const std::vector<FloorPlan::PathPoint>& path) {
  Paper extent{Eigen::Vector2d::Constant(INFINITY), Eigen::Vector2d::Constant(-INFINITY)};
  for (int axis = 0; axis < 2 && !points.empty(); ++axis) {
    std::vector<double> values;
    values.reserve(points.size());
    for (const auto& p : points) values.push_back(p[axis]);
    std::sort(values.begin(), values.end());
    const size_t skip = static_cast<size_t>(kOutlierShare * static_cast<double>(values.size()));
    extent.min[axis] = values[skip] - 0.2;
    extent.max[axis] = values[values.size() - 1 - skip] + 0.2;
  }
  for (const auto& point : path) {
    extent.min = extent.min.cwiseMin((point.position_map.array() - 0.5).matrix());
    extent.max = extent.max.cwiseMax((point.position_map.array() + 0.5).matrix());
  }
  if (!extent.min.allFinite()) return {Eigen::Vector2d::Constant(-1), Eigen::Vector2d::Constant(1)};
  return extent;
}

Raster makeInk(const std::vector<Eigen::Vector2d>& points, const Paper& extent, uint8_t darkest) {
  Raster ink;
  ink.cell = kCell_m;
  ink.origin = (extent.min / kCell_m).array().floor() * kCell_m;
  const Eigen::Vector2d size = ((extent.max - ink.origin) / kCell_m).array().ceil();
  if (size.x() * size.y() > kMaxStoreyCells) return ink;
  ink.width = static_cast<int>(size.x());
  ink.height = static_cast<int>(size.y());
  std::vector<int> counts(static_cast<size_t>(ink.width) * ink.height, 0);
  for (const auto& p : points) {
    const Eigen::Vector2d cell = ((p - ink.origin) / kCell_m).array().floor();
    if (cell.x() < 0 || cell.y() < 0 || cell.x() >= ink.width || cell.y() >= ink.height) continue;
    ++counts[static_cast<size_t>(cell.y()) * ink.width + static_cast<size_t>(cell.x())];
  }
  for (int level = 1; level <= kGreys; ++level) {
    const auto grey =
        static_cast<uint8_t>(kLightestGrey - (kLightestGrey - darkest) * (level - 1) / (kGreys - 1));
    ink.palette.push_back({grey, grey, grey});
  }
  ink.indices.reserve(counts.size());
  for (const int count : counts)
    ink.indices.push_back(static_cast<uint8_t>(
        std::min<double>(kGreys, std::ceil(kGreys * std::sqrt(std::min(1.0, count / kFullInk))))));
  return ink;
}

std::vector<FloorPlan::PathPoint> pathOn(const SituationalGraph& graph, FloorId floor,
                                         std::span<const OdometryEstimate> scans) {
  std::vector<FloorPlan::PathPoint> path;
  const auto poses = denseTrajectory(graph, scans);
  bool joined = false;
  for (size_t i = 0; i < poses.size(); ++i) {
    const auto node = graph.keyframes.find(scans[i].keyframe);
    const FloorId here = node == graph.keyframes.end() ? FloorId{0} : floorOf(node->second);
    if (here != floor) {
      joined = false;
      continue;
    }
    const Eigen::Vector2d p = poses[i].pose.translation.head<2>();
    const bool is_last = i + 1 == poses.size();
    if (joined && !is_last && (p - path.back().position_map).norm() < kPathStep_m) continue;
    path.push_back({p, (poses[i].time - poses.front().time).seconds(), joined});
    joined = true;
  }
  return path;
}

}  // namespace

FloorPlan makeFloorPlan(const SituationalGraph& graph, const FloorNode& floor, std::span<const MapPoint> map,
                        std::span<const OdometryEstimate> scans) {
  FloorPlan plan;
  plan.floor = floor.id;
  plan.height_known = floor.height_known;
  plan.walls = wallLines(graph, floor);
  plan.rooms = planRooms(graph, floor.id);
  plan.doors = planDoors(graph, floor.id);
  plan.path = pathOn(graph, floor.id, scans);
  if (!scans.empty()) plan.duration_s = (scans.back().time - scans.front().time).seconds();
  const auto slice = slicePoints(map, floor.id, StoreyHeight(graph, floor));
  plan.extent = robustExtent(slice, plan.path);
  plan.ink = makeInk(slice, plan.extent, plan.walls.empty() ? kDarkestGrey : kGreyBehindWalls);
  return plan;
}

}  // namespace sgraphs
