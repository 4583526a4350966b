#include "perception/relocalise/known_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "perception/loops/place_walls.h"

namespace sgraphs {
namespace {

// The robot may stand this far beside where it has been, on a grid as fine as the layout's first search.
constexpr double kBeside_m = 2.0;
constexpr double kGrid_m = 0.5;

std::vector<KnownPlace> thinned(const std::vector<const MapView*>& views, double spacing_m) {
  std::vector<KnownPlace> out;
  for (const MapView* v : views) {
    const bool near = std::any_of(out.begin(), out.end(), [&](const KnownPlace& p) {
      return (p.T_map_body.translation - v->T_map_body.translation).norm() < spacing_m;
    });
    if (!near && !v->keyframe->points.empty()) out.push_back({Place(*v->keyframe), v->T_map_body});
  }
  return out;
}

std::vector<Eigen::Vector2d> gridBeside(const std::vector<KnownPlace>& places) {
  const int reach = static_cast<int>(std::ceil(kBeside_m / kGrid_m));
  std::set<std::pair<int, int>> cells;
  for (const KnownPlace& p : places) {
    const auto x = static_cast<int>(std::lround(p.T_map_body.translation.x() / kGrid_m));
    const auto y = static_cast<int>(std::lround(p.T_map_body.translation.y() / kGrid_m));
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx)
        if (dx * dx + dy * dy <= reach * reach) cells.insert({y + dy, x + dx});
  }
  std::vector<Eigen::Vector2d> out;
  out.reserve(cells.size());
  for (const auto& [y, x] : cells) out.emplace_back(kGrid_m * x, kGrid_m * y);
  return out;
}

WallLayout layoutOf(const std::vector<KnownPlace>& places) {
  Eigen::AlignedBox2d box;
  std::vector<PlacedPlace> placed;
  for (const KnownPlace& p : places) {
    box.extend(p.T_map_body.translation.head<2>());
    placed.push_back({&p.place, p.T_map_body});
  }
  const Eigen::Vector2d centre = places.empty() ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(box.center());
  const double half_m = places.empty() ? 0 : 0.5 * box.sizes().maxCoeff();
  WallLayout layout(centre, half_m + kBeside_m + kQueryReach_m);
  for (const WallPoint& w : wallsOf(placed)) layout.add(w);
  return layout;
}

}  // namespace

KnownStorey::KnownStorey(const std::vector<const MapView*>& views, double spacing_m)
    : places_(thinned(views, spacing_m)), positions_map_(gridBeside(places_)), layout_(layoutOf(places_)) {}

std::vector<LayoutMatch> KnownStorey::search(const std::vector<WallPoint>& query, int max_matches) const {
  if (positions_map_.empty()) return {};
  LayoutSearch where;
  where.yaw_range_rad = std::numbers::pi;
  where.max_matches = max_matches;
  where.positions_map = positions_map_;
  return layout_.search(query, where);
}

const KnownPlace* KnownStorey::nearest(const Eigen::Vector2d& position_map, double within_m) const {
  return nearestFromAbove(places_, position_map, within_m);
}

OldSurroundings KnownStorey::surroundingsOf(const KnownPlace& anchor, double radius_m) const {
  const SE3 T_anchor_map = anchor.T_map_body.inverse();
  std::vector<PlacedPlace> near;
  for (const KnownPlace& p : places_) {
    const SE3 T_anchor_body = T_anchor_map * p.T_map_body;
    if (T_anchor_body.translation.norm() <= radius_m) near.push_back({&p.place, T_anchor_body});
  }
  return OldSurroundings::ofNearest(std::move(near));
}

}  // namespace sgraphs
