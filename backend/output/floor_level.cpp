#include "backend/output/floor_level.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace sgraphs {
namespace {

constexpr double kReach_m = 3.0;      // map points this close to the path lie on the surface it walks on
constexpr double kClearance_m = 0.1;  // a body is at least this high
constexpr double kBin_m = 0.02;
constexpr double kMaxDepth_m = 2.5;  // below the path; deeper is another storey
constexpr int kWindow = 2;           // bins to each side of a peak
constexpr int64_t kMinPoints = 50;
// Of the points below the path. Walls alone spread evenly: between a body's clearance and its feet the window
// then holds about a quarter.
constexpr double kMinShare = 0.4;
constexpr double kFallbackBody_m = 0.5;  // height of a legged robot's body

using Cell = std::pair<int, int>;

Cell cellOf(const Eigen::Vector3d& p) {
  return {static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y()))};
}

// Lowest height of the path in each square metre within reach of it.
std::map<Cell, double> pathHeights(const SituationalGraph& graph, FloorId floor) {
  std::map<Cell, double> heights;
  const int reach = static_cast<int>(kReach_m);
  for (const auto& [id, node] : graph.keyframes) {
    if (floorOf(node) != floor) continue;
    const double height = graph.up_map.dot(node.T_map_body.translation);
    const auto [cx, cy] = cellOf(node.T_map_body.translation);
    for (int x = cx - reach; x <= cx + reach; ++x)
      for (int y = cy - reach; y <= cy + reach; ++y) {
        const auto [found, is_new] = heights.try_emplace({x, y}, height);
        if (!is_new) found->second = std::min(found->second, height);
      }
  }
  return heights;
}

std::vector<double> heightsBelowPath(const SituationalGraph& graph, std::span<const MapPoint> map,
                                     FloorId floor) {
  const auto path = pathHeights(graph, floor);
  std::vector<double> below;
  for (const MapPoint& point : map) {
    if (point.floor != floor) continue;
    const Eigen::Vector3d p = point.position_map.cast<double>();
    const auto found = path.find(cellOf(p));
    if (found == path.end()) continue;
    const double height = graph.up_map.dot(p);
    if (height < found->second - kClearance_m && height > found->second - kMaxDepth_m)
      below.push_back(height);
  }
  return below;
}

std::optional<double> lowestDominant(const std::vector<double>& heights) {
  std::map<int, int64_t> histogram;
  for (const double h : heights) ++histogram[static_cast<int>(std::floor(h / kBin_m))];
  const auto window = [&](int bin) {
    int64_t sum = 0;
    for (auto it = histogram.lower_bound(bin - kWindow); it != histogram.end() && it->first <= bin + kWindow;
         ++it)
      sum += it->second;
    return sum;
  };
  int64_t highest = 0;
  for (const auto& [bin, count] : histogram) highest = std::max(highest, window(bin));
  if (highest < kMinPoints || static_cast<double>(highest) < kMinShare * static_cast<double>(heights.size()))
    return std::nullopt;
  // The lowest peak of comparable strength, then up to its own top.
  auto peak = histogram.begin();
  while (2 * window(peak->first) < highest) ++peak;
  for (auto next = std::next(peak);
       next != histogram.end() && window(next->first) > window(peak->first) && next->first <= peak->first + 1;
       ++next)
    peak = next;
  double sum = 0;
  int64_t count = 0;
  for (const double h : heights)
    if (std::abs(std::floor(h / kBin_m) - peak->first) <= kWindow) sum += h, ++count;
  return sum / static_cast<double>(count);
}

Eigen::Vector2d meanPosition(const SituationalGraph& graph, FloorId floor) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int64_t count = 0;
  for (const auto& [id, node] : graph.keyframes)
    if (floorOf(node) == floor) sum += node.T_map_body.translation.head<2>(), ++count;
  return count ? Eigen::Vector2d(sum / static_cast<double>(count)) : sum;
}

}  // namespace

std::set<FloorId> floorsOfUnknownHeight(const SituationalGraph& graph) {
  std::set<FloorId> unknown;
  if (graph.keyframes.empty()) return unknown;
  // Keyframes whose heights are measured against each other, from the first one on.
  std::map<KeyframeId, std::vector<KeyframeId>> neighbours;
  for (const RelativePoseFactor& factor : graph.relative_poses) {
    const RelativePose& z = factor.measurement;
    if (leavesHeightOpen(z)) continue;
    neighbours[z.from].push_back(z.to);
    neighbours[z.to].push_back(z.from);
  }
  std::set<KeyframeId> known{graph.keyframes.begin()->first};
  for (std::vector<KeyframeId> open{*known.begin()}; !open.empty();) {
    const KeyframeId id = open.back();
    open.pop_back();
    for (const KeyframeId next : neighbours[id])
      if (known.insert(next).second) open.push_back(next);
  }
  for (const auto& [id, node] : graph.keyframes) unknown.insert(floorOf(node));
  for (const KeyframeId id : known) unknown.erase(floorOf(graph.keyframes.at(id)));
  return unknown;
}

std::map<FloorId, FloorNode> describeFloors(const SituationalGraph& graph, std::span<const MapPoint> map) {
  std::map<FloorId, FloorNode> floors = graph.floors;
  for (const auto& [id, node] : graph.keyframes) floors.try_emplace(floorOf(node));
  if (floors.empty()) floors.try_emplace(FloorId{0});
  const std::set<FloorId> unknown = floorsOfUnknownHeight(graph);
  for (auto& [id, floor] : floors) {
    floor.id = id;
    floor.height_known = !unknown.contains(id);
    if (floor.has_height) continue;
    floor.center_map = meanPosition(graph, id);
    const auto height = lowestDominant(heightsBelowPath(graph, map, id));
    floor.has_height = height.has_value();
    // On the plane up . p = height, above the storey's centre.
    if (height) floor.z_m = (*height - graph.up_map.head<2>().dot(floor.center_map)) / graph.up_map.z();
  }
  return floors;
}

StoreyHeight::StoreyHeight(const SituationalGraph& graph, const FloorNode& floor) : up_(graph.up_map) {
  if (floor.has_height) {
    surface_ = up_.dot(Eigen::Vector3d(floor.center_map.x(), floor.center_map.y(), floor.z_m));
    return;
  }
  std::vector<double> heights;
  for (const auto& [id, node] : graph.keyframes)
    if (floorOf(node) == floor.id) heights.push_back(up_.dot(node.T_map_body.translation));
  if (heights.empty()) return;
  std::nth_element(heights.begin(), heights.begin() + static_cast<ptrdiff_t>(heights.size() / 2),
                   heights.end());
  surface_ = heights[heights.size() / 2] - kFallbackBody_m;
}

}  // namespace sgraphs
