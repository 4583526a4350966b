#include "tests/perception/free_space/clusters/clusters_truth.h"

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

bool holds(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& p) {
  bool in = false;
  for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
      in = !in;
  }
  return in;
}

bool inAnyRoom(const simulate::Scene& scene, int floor, const Eigen::Vector2d& p) {
  return std::any_of(scene.rooms.begin(), scene.rooms.end(),
                     [&](const auto& room) { return room.floor == floor && holds(room.polygon, p); });
}

}  // namespace

std::vector<RoomScore> scoreRooms(const simulate::Scene& scene, const PlanView& view, const StoreyGrid& grid,
                                  const Segmentation& segmentation) {
  const auto count = static_cast<size_t>(segmentation.regions.count);
  std::vector<int> size(count, 0);
  for (const int32_t label : segmentation.regions.labels)
    if (label != kNoLabel) ++size[static_cast<size_t>(label)];
  std::vector<RoomScore> scores;
  for (const auto& room : scene.rooms) {
    if (room.floor != view.floor) continue;
    std::vector<int> shared(count, 0);
    int cells = 0;
    for (size_t i = 0; i < grid.state.size(); ++i) {
      if (!holds(room.polygon, toMap(centerOf(grid, i), -view.yaw_rad))) continue;
      ++cells;
      const int32_t label = segmentation.regions.labels[i];
      if (label != kNoLabel) ++shared[static_cast<size_t>(label)];
    }
    const auto best = std::max_element(shared.begin(), shared.end()) - shared.begin();
    const auto k = static_cast<size_t>(best);
    scores.push_back({room.id, static_cast<double>(shared[k]) / (cells + size[k] - shared[k]),
                      static_cast<int32_t>(best)});
  }
  return scores;
}

std::vector<DoorScore> scoreDoors(const simulate::Scene& scene, const PlanView& view,
                                  const Segmentation& segmentation) {
  std::vector<DoorScore> scores;
  for (const auto& door : scene.doorways) {
    const Eigen::Vector2d p = door.xyz.head<2>();
    if (door.floor != view.floor) continue;
    // Doors to the outside have no free space behind them in these grids.
    int sides = 0;
    for (const Eigen::Vector2d& step : {Eigen::Vector2d(0.5, 0), Eigen::Vector2d(-0.5, 0),
                                        Eigen::Vector2d(0, 0.5), Eigen::Vector2d(0, -0.5)})
      sides += inAnyRoom(scene, view.floor, p + step) ? 1 : 0;
    if (sides < 2) continue;
    DoorScore score;
    score.place_building = p;
    for (const RegionPassage& passage : segmentation.passages) {
      const double d_m = (passage.cut.middle() - toMap(p, view.yaw_rad)).norm();
      if (d_m >= score.distance_m) continue;
      score.distance_m = d_m;
      score.width_error_m = passage.cut.width() - door.width_m;
    }
    scores.push_back(score);
  }
  return scores;
}

}  // namespace sgraphs
