#include "backend/rooms/center_binding.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

// Pairs whose mid-planes enclose less than about 25 degrees determine one direction only.
constexpr double kLeastSpread = 0.1;
// Factors are made anew where what they hold has changed by more than this.
constexpr double kMovedAlong_m = 0.25;
constexpr double kMovedHeight_m = 0.5;
constexpr double kSameDirection = 0.98;

using Pairs = std::vector<std::pair<PlaneId, PlaneId>>;

Eigen::Vector2d midplaneNormal(const SituationalGraph& graph, const std::pair<PlaneId, PlaneId>& pair) {
  return (graph.planes.at(pair.first).normal_map - graph.planes.at(pair.second).normal_map)
      .head<2>()
      .normalized();
}

// At most two, across each other.
Pairs independent(const SituationalGraph& graph, const Pairs& pairs) {
  Pairs chosen;
  for (const auto& pair : pairs) {
    if (chosen.size() == 2) break;
    if (chosen.empty() ||
        1.0 - std::abs(midplaneNormal(graph, chosen[0]).dot(midplaneNormal(graph, pair))) > kLeastSpread)
      chosen.push_back(pair);
  }
  return chosen;
}

std::vector<Eigen::Vector2d> openDirections(const SituationalGraph& graph, const Pairs& pairs) {
  if (pairs.size() == 2) return {};
  if (pairs.empty()) return {Eigen::Vector2d::UnitX(), Eigen::Vector2d::UnitY()};
  const Eigen::Vector2d n = midplaneNormal(graph, pairs[0]);
  return {Eigen::Vector2d(-n.y(), n.x())};
}

void bindWalls(const CenterEvidence& evidence, const Pairs& pairs, GraphBuilder& builder) {
  std::vector<bool> bound(pairs.size(), false);
  std::vector<int64_t> outdated;
  for (const CenterWallsFactor& f : builder.graph().center_walls) {
    if (!(f.of == evidence.of)) continue;
    const auto same = std::find_if(pairs.begin(), pairs.end(), [&](const auto& pair) {
      return std::minmax(pair.first, pair.second) == std::minmax(f.a, f.b);
    });
    const bool stays = same != pairs.end() && f.finite == evidence.finite &&
                       std::abs(f.height_m - evidence.height_m) < kMovedHeight_m;
    if (stays)
      bound[static_cast<size_t>(same - pairs.begin())] = true;
    else
      outdated.push_back(f.id);
  }
  for (const int64_t id : outdated) builder.removeFactor(id);
  for (size_t i = 0; i < pairs.size(); ++i)
    if (!bound[i])
      builder.addCenterWalls({.id = 0,
                              .of = evidence.of,
                              .a = pairs[i].first,
                              .b = pairs[i].second,
                              .finite = evidence.finite,
                              .height_m = evidence.height_m,
                              .sigma_m = evidence.wall_sigma_m});
}

bool holds(const CenterAnchorFactor& f, const Eigen::Vector2d& along_map, const Eigen::Vector2d& center_map,
           const SituationalGraph& graph) {
  const SE3& T_map_body = graph.keyframes.at(f.keyframe).T_map_body;
  const Eigen::Vector2d held = (T_map_body * f.center_body).head<2>();
  const Eigen::Vector2d along = (T_map_body.rotation * f.along_body).head<2>();
  return std::abs(along.dot(along_map)) > kSameDirection &&
         std::abs(along_map.dot(center_map - held)) < kMovedAlong_m;
}

void bindAnchors(const CenterEvidence& evidence, const std::vector<Eigen::Vector2d>& open,
                 GraphBuilder& builder) {
  const SituationalGraph& graph = builder.graph();
  std::vector<int64_t> before;
  size_t held = 0;
  for (const CenterAnchorFactor& f : graph.center_anchors) {
    if (!(f.of == evidence.of)) continue;
    before.push_back(f.id);
    held += static_cast<size_t>(std::count_if(open.begin(), open.end(), [&](const Eigen::Vector2d& u) {
      return holds(f, u, evidence.center_map, graph);
    }));
  }
  if (before.size() == open.size() && held == open.size()) return;
  for (const int64_t id : before) builder.removeFactor(id);
  const SE3 T_body_map = graph.keyframes.at(evidence.anchor).T_map_body.inverse();
  for (const Eigen::Vector2d& u : open)
    builder.addCenterAnchor(
        {.id = 0,
         .of = evidence.of,
         .keyframe = evidence.anchor,
         .center_body = T_body_map *
                        Eigen::Vector3d(evidence.center_map.x(), evidence.center_map.y(), evidence.height_m),
         .along_body = (T_body_map.rotation * Eigen::Vector3d(u.x(), u.y(), 0)).normalized(),
         .sigma_m = evidence.along_sigma_m});
}

}  // namespace

void bindCenter(const CenterEvidence& evidence, GraphBuilder& builder) {
  const Pairs pairs = independent(builder.graph(), evidence.pairs);
  bindWalls(evidence, pairs, builder);
  bindAnchors(evidence, openDirections(builder.graph(), pairs), builder);
}

}  // namespace sgraphs
