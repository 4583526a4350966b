#include "backend/rooms/room_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "backend/graph/map_plane.h"
#include "common/geometry/tangent_basis.h"

namespace sgraphs {
namespace {

constexpr double kTolerance = 2.0, kGate = 4.0;  // sigmas
constexpr double kStays = 1.25;

// Of the observed normal, for a turn about the vertical: along t = up x n, as long as n is level.
double headingVariance(const PlaneObservation& z, const SE3& T_map_body) {
  const Eigen::Vector3d up_body = T_map_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector2d t = tangentBasis(z.normal_body).transpose() * up_body.cross(z.normal_body);
  const double level = t.squaredNorm();
  if (level < 0.5) return std::numeric_limits<double>::infinity();
  return (t.transpose() * z.covariance.topLeftCorner<2, 2>() * t).value() / (level * level);
}

std::vector<WallRelation> candidates(const RoomObservation& room) {
  std::vector<WallRelation> all;
  const auto add = [&](PlaneId a, PlaneId b, bool square) {
    if (!a.valid() || !b.valid() || a == b) return;
    const auto known = std::find_if(all.begin(), all.end(), [&](const WallRelation& r) {
      return r.a == std::min(a, b) && r.b == std::max(a, b);
    });
    if (known == all.end()) all.push_back({std::min(a, b), std::max(a, b), square, 0});
  };
  for (const auto& [a, b] : room.pairs) add(a, b, false);
  for (size_t i = 0; i < room.polygon.size(); ++i)
    add(room.polygon[i].wall, room.polygon[(i + 1) % room.polygon.size()].wall, true);
  return all;
}

double departure(const WallRelation& relation, const SituationalGraph& graph) {
  const Eigen::Vector3d &a = graph.planes.at(relation.a).normal_map,
                        &b = graph.planes.at(relation.b).normal_map;
  if (std::max(std::abs(a.z()), std::abs(b.z())) > kPlumbNormal)
    return std::numeric_limits<double>::infinity();
  const double sine = relation.square ? a.dot(b) : a.cross(b).z();
  return std::asin(std::clamp(std::abs(sine), 0.0, 1.0));
}

}  // namespace

void HeadingEvidence::update(const SituationalGraph& graph) {
  for (auto it = information_.begin(); it != information_.end();) {
    const PlaneId now = livesOnIn(graph, it->first);
    if (now == it->first) {
      ++it;
      continue;
    }
    information_[now] += it->second;
    it = information_.erase(it);
  }
  for (; num_taken_ < graph.observations.size(); ++num_taken_) {
    const ObservationFactor& factor = graph.observations[num_taken_];
    const SE3& T_map_body = graph.keyframes.at(factor.keyframe).T_map_body;
    information_[factor.plane] += 1.0 / headingVariance(factor.measurement, T_map_body);
  }
}

double HeadingEvidence::variance(PlaneId plane) const {
  const auto known = information_.find(plane);
  return known == information_.end() ? std::numeric_limits<double>::infinity() : 1.0 / known->second;
}

std::vector<WallRelation> wallRelations(const RoomObservation& room, const SituationalGraph& graph,
                                        const HeadingEvidence& headings, double shape_sigma_rad,
                                        const std::set<std::pair<PlaneId, PlaneId>>& before) {
  std::vector<WallRelation> relations = candidates(room);
  std::erase_if(relations, [&](const WallRelation& r) {
    const double variance = headings.variance(r.a) + headings.variance(r.b);
    if (!std::isfinite(variance)) return true;
    const double gate = kTolerance * shape_sigma_rad + kGate * std::sqrt(variance);
    return departure(r, graph) > (before.contains({r.a, r.b}) ? kStays * gate : gate);
  });
  std::set<PlaneId> walls;
  for (const WallRelation& r : relations) walls.insert({r.a, r.b});
  const double determined = static_cast<double>(walls.size()) - 1.0;
  for (WallRelation& r : relations)
    r.sigma_rad =
        shape_sigma_rad * std::sqrt(std::max(1.0, static_cast<double>(relations.size()) / determined));
  return relations;
}

}  // namespace sgraphs
