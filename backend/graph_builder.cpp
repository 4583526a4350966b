#include "backend/graph_builder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "backend/factors/faces_cost.h"
#include "backend/factors/plane_up_cost.h"
#include "backend/factors/pose_plane_cost.h"
#include "backend/factors/relative_pose_cost.h"
#include "backend/factors/same_height_cost.h"
#include "backend/factors/up_cost.h"
#include "backend/levelling.h"
#include "backend/planes/plane_extent.h"
#include "backend/planes/plane_residual.h"

namespace sgraphs {
namespace {

// Observations of planes count as quadratic up to these multiples of their robust scale, one after the other,
// where a solve starts from afar.
constexpr double kFromAfar[] = {100, 30, 10, 3};
// A neighbour factor over more keyframes than this closes a circle: its effect is not local.
constexpr int64_t kLocalSpan = 10;
// A loop was verified before it came, while odometry may drift by several times what it says: it gives in to
// other loops, and to odometry only where LoopLayer would not have let it in.
constexpr double kCauchyLoop = 10.0;

const char* kindOf(const RelativePose& z) {
  if (z.kind == RelativePoseKind::kOdometry) return "odometry";
  return z.kind == RelativePoseKind::kNeighbour ? "neighbour" : "loop";
}

PlaneState stateOf(const PlaneNode& plane) {
  return {plane.normal_map, plane.offset_m, plane.anchor_map};
}

void turnNormal(PlaneNode& plane, const Eigen::Vector3d& normal_map) {
  plane.covariance = reframedCovariance(plane.covariance, plane.normal_map, normal_map);
  plane.normal_map = normal_map;
}

void movePlane(PlaneNode& plane, const SE3& T_new_old) {
  turnNormal(plane, T_new_old.rotation * plane.normal_map);
  plane.anchor_map = T_new_old * plane.anchor_map;
  plane.centroid_map = T_new_old * plane.centroid_map;
  for (Eigen::Vector3d& corner : plane.polygon_map) corner = T_new_old * corner;
}

}  // namespace

int64_t GraphBuilder::add(const std::string& kind, std::unique_ptr<ceres::CostFunction> cost,
                          const std::vector<StateId>& states, std::optional<double> cauchy_scale) {
  const int64_t id = next_factor_++;
  factors_[id] = {kind, solver_.addFactor(std::move(cost), states, cauchy_scale)};
  return id;
}

void GraphBuilder::drop(int64_t factor) {
  solver_.setEnabled(factors_.at(factor).factor, false);
  factors_.erase(factor);
}

void GraphBuilder::addKeyframe(KeyframeNode node) {
  const StateId state = solver_.addPose(node.T_map_body);
  if (graph_.keyframes.empty()) solver_.hold(state);
  keyframe_states_[node.id] = state;
  keyframe_of_state_[state] = node.id;
  const KeyframeId id = node.id;
  graph_.keyframes.emplace(id, std::move(node));
}

PlaneId GraphBuilder::addPlane(PlaneNode node) {
  node.id = PlaneId{next_plane_++};
  const StateId state = solver_.addPlane(stateOf(node));
  plane_states_[node.id] = state;
  plane_of_state_[state] = node.id;
  const PlaneId id = node.id;
  graph_.planes.emplace(id, std::move(node));
  return id;
}

bool GraphBuilder::closesCircle(const RelativePose& z) {
  return z.kind == RelativePoseKind::kLoop || std::abs(z.from.value - z.to.value) > kLocalSpan;
}

int64_t GraphBuilder::addRelativePose(const RelativePose& z) {
  const bool loop = z.kind == RelativePoseKind::kLoop;
  const int64_t id = add(kindOf(z), RelativePoseCost::Create(z.T_from_to, z.covariance),
                         {keyframe_states_.at(z.from), keyframe_states_.at(z.to)},
                         loop ? std::optional<double>(kCauchyLoop) : std::nullopt);
  graph_.relative_poses.push_back({id, z});
  return id;
}

void GraphBuilder::switchLoop(LoopId id, bool on) {
  KnownLoop& loop = graph_.loops.at(id);
  if (loop.active() == on) return;
  if (on) {
    loop.factor = addRelativePose(loop.measurement);
    return;
  }
  drop(loop.factor);
  std::erase_if(graph_.relative_poses, [&](const RelativePoseFactor& f) { return f.id == loop.factor; });
  loop.factor = -1;
}

void GraphBuilder::removeLoop(LoopId id) {
  switchLoop(id, false);
  graph_.loops.erase(id);
}

GraphBuilder::StateId GraphBuilder::upState() {
  if (up_state_ < 0) up_state_ = solver_.addSharedUnitVector(graph_.up_map);
  return up_state_;
}

void GraphBuilder::addUp(KeyframeId keyframe, const Eigen::Vector3d& up_body, double sigma_rad) {
  if (up_state_ < 0) graph_.up_map = graph_.keyframes.at(keyframe).T_map_body.rotation * up_body;
  const int64_t id =
      add("up", UpCost::Create(up_body, sigma_rad), {keyframe_states_.at(keyframe), upState()}, {});
  graph_.ups.push_back({id, keyframe, up_body, sigma_rad});
}

void GraphBuilder::addObservation(KeyframeId keyframe, PlaneId plane, const PlaneObservation& z) {
  const int64_t id = add("observes", PosePlaneCost::Create(z),
                         {keyframe_states_.at(keyframe), plane_states_.at(plane)}, kCauchy3);
  graph_.observations.push_back({id, keyframe, plane, z});
  graph_.planes.at(plane).num_observations += 1;
}

void GraphBuilder::removeObservations(const std::set<int64_t>& ids) {
  std::erase_if(graph_.observations, [&](const ObservationFactor& f) {
    if (!ids.contains(f.id)) return false;
    drop(f.id);
    graph_.planes.at(f.plane).num_observations -= 1;
    return true;
  });
  std::erase_if(trusted_, [&](int64_t id) { return ids.contains(id); });
}

void GraphBuilder::addPlaneUp(PlaneId plane, bool level, double sigma_rad) {
  auto cost = PlaneUpCost::Create(level ? PlaneUpCost::Kind::kLevel : PlaneUpCost::Kind::kPlumb, sigma_rad);
  const int64_t id =
      add("plane_up", std::move(cost), {plane_states_.at(plane), upState()}, level ? kCauchy2 : kCauchy1);
  graph_.plane_ups.push_back({id, plane, level, sigma_rad});
}

void GraphBuilder::addFaces(PlaneId a, PlaneId b, double sigma_rad) {
  const int64_t id =
      add("faces", FacesCost::Create(sigma_rad), {plane_states_.at(a), plane_states_.at(b)}, kCauchy2);
  graph_.faces.push_back({id, a, b, sigma_rad});
}

void GraphBuilder::addSameHeight(PlaneId a, PlaneId b, double sigma_m) {
  const int64_t id = add("same_height", SameHeightCost::Create(sigma_m),
                         {plane_states_.at(a), plane_states_.at(b), upState()}, kCauchy1);
  graph_.same_heights.push_back({id, a, b, sigma_m});
}

void GraphBuilder::trust(PlaneId plane) {
  for (const ObservationFactor& f : graph_.observations) {
    if (f.plane != plane) continue;
    solver_.setCauchyScale(factors_.at(f.id).factor, std::nullopt);
    trusted_.push_back(f.id);
  }
}

// Observations move over. Factors between planes and with `up` go where `into` has the same already; a factor
// of the two with each other is void.
void GraphBuilder::mergePlanes(PlaneId from, PlaneId into) {
  const StateId old_state = plane_states_.at(from), state = plane_states_.at(into);
  for (ObservationFactor& factor : graph_.observations) {
    if (factor.plane != from) continue;
    solver_.rebind(factors_.at(factor.id).factor, old_state, state);
    factor.plane = into;
  }
  const bool has_up = std::any_of(graph_.plane_ups.begin(), graph_.plane_ups.end(),
                                  [&](const PlaneUpFactor& f) { return f.plane == into; });
  if (has_up)
    std::erase_if(graph_.plane_ups, [&](const PlaneUpFactor& f) {
      const bool void_now = f.plane == from;
      if (void_now) drop(f.id);
      return void_now;
    });
  for (PlaneUpFactor& f : graph_.plane_ups) {
    if (f.plane != from) continue;
    solver_.rebind(factors_.at(f.id).factor, old_state, state);
    f.plane = into;
  }
  const auto rebindPairs = [&](auto& pairs) {
    const auto before = std::exchange(pairs, {});
    for (auto f : before) {
      if (f.a == from || f.b == from) {
        const PlaneId other = f.a == from ? f.b : f.a;
        const auto same = [&](const auto& g) {
          return (g.a == into && g.b == other) || (g.b == into && g.a == other);
        };
        if (other == into || std::any_of(before.begin(), before.end(), same)) {
          drop(f.id);
          continue;
        }
        solver_.rebind(factors_.at(f.id).factor, old_state, state);
        (f.a == from ? f.a : f.b) = into;
      }
      pairs.push_back(f);
    }
  };
  rebindPairs(graph_.faces);
  rebindPairs(graph_.same_heights);
  mergeInRooms(from, into, old_state, state);

  PlaneNode& kept = graph_.planes.at(into);
  const PlaneNode& gone = graph_.planes.at(from);
  if (!kept.floor.valid()) kept.floor = gone.floor;
  Polygon2d extent = extentOf(kept);
  const Polygon2d more = extentOn(kept, gone);
  extent.insert(extent.end(), more.begin(), more.end());
  sgraphs::setExtent(kept, std::move(extent));
  kept.num_observations += gone.num_observations;
  graph_.merged_planes[from] = into;
  graph_.planes.erase(from);
  plane_of_state_.erase(old_state);
  plane_states_.erase(from);
}

void GraphBuilder::relevel() {
  if (up_state_ < 0) return;
  const SE3 first = graph_.keyframes.begin()->second.T_map_body;
  const Eigen::Quaterniond levelled = levelledRotation(first.rotation.conjugate() * graph_.up_map);
  const SE3 T_new_old = SE3(levelled, first.translation) * first.inverse();
  for (auto& [id, node] : graph_.keyframes) {
    node.T_map_body = T_new_old * node.T_map_body;
    solver_.setPose(keyframe_states_.at(id), node.T_map_body);
  }
  for (auto& [id, plane] : graph_.planes) {
    movePlane(plane, T_new_old);
    solver_.setPlane(plane_states_.at(id), stateOf(plane));
  }
  graph_.up_map = Eigen::Vector3d::UnitZ();
  solver_.setUnitVector(up_state_, graph_.up_map);
}

void GraphBuilder::moveKeyframes(const std::map<KeyframeId, SE3>& T_map_body) {
  std::map<PlaneId, KeyframeId> first;
  for (const ObservationFactor& f : graph_.observations) {
    const auto [known, fresh] = first.try_emplace(f.plane, f.keyframe);
    if (!fresh) known->second = std::min(known->second, f.keyframe);
  }
  for (const auto& [id, keyframe] : first) {
    const auto now = T_map_body.find(keyframe);
    if (now == T_map_body.end()) continue;
    PlaneNode& plane = graph_.planes.at(id);
    movePlane(plane, now->second * graph_.keyframes.at(keyframe).T_map_body.inverse());
    solver_.setPlane(plane_states_.at(id), stateOf(plane));
  }
  for (auto& [id, node] : graph_.keyframes) {
    const auto now = T_map_body.find(id);
    if (now == T_map_body.end() || id == graph_.keyframes.begin()->first) continue;
    node.T_map_body = now->second;
    solver_.setPose(keyframe_states_.at(id), node.T_map_body);
  }
}

IncrementalSolver::Report GraphBuilder::solveFromAfar() {
  const auto scale = [&](double multiple) {
    for (const ObservationFactor& f : graph_.observations)
      solver_.setCauchyScale(factors_.at(f.id).factor, multiple * kCauchy3);
  };
  for (const double multiple : kFromAfar) {
    scale(multiple);
    takeOver(solver_.solve(true).free);
  }
  scale(1.0);
  trusted_.clear();
  return solve(true);
}

IncrementalSolver::Report GraphBuilder::solve(bool whole) {
  IncrementalSolver::Report report = solver_.solve(whole);
  if (!trusted_.empty() && report.whole && report.converged) {
    for (const int64_t id : std::exchange(trusted_, {}))
      solver_.setCauchyScale(factors_.at(id).factor, kCauchy3);
    report = solver_.solve(true);
  }
  takeOver(report.free);
  return report;
}

void GraphBuilder::takeOver(const std::vector<StateId>& states) {
  for (const StateId state : states) {
    if (const auto keyframe = keyframe_of_state_.find(state); keyframe != keyframe_of_state_.end())
      graph_.keyframes.at(keyframe->second).T_map_body = solver_.pose(state);
    takeOverCenter(state);
    const auto found = plane_of_state_.find(state);
    if (found == plane_of_state_.end()) continue;
    PlaneNode& plane = graph_.planes.at(found->second);
    const PlaneState value = solver_.plane(state);
    turnNormal(plane, value.normal);
    plane.offset_m = value.offset_m;
    // Extents lie in the plane: they follow it. Taken in its new axes, which may have flipped.
    sgraphs::setExtent(plane, extentOf(plane));
  }
  if (up_state_ >= 0) graph_.up_map = solver_.unitVector(up_state_);
}

void GraphBuilder::setExtent(PlaneId plane, const std::vector<Eigen::Vector2d>& points) {
  sgraphs::setExtent(graph_.planes.at(plane), points);
}

void GraphBuilder::setCovariance(PlaneId plane, const Eigen::Matrix3d& at_centroid) {
  graph_.planes.at(plane).covariance = at_centroid;
}

std::optional<Matrix6d> GraphBuilder::covariance(KeyframeId id) const {
  return solver_.covariance(keyframe_states_.at(id));
}

std::map<KeyframeId, Matrix6d> GraphBuilder::keyframeCovariances() const {
  std::map<KeyframeId, Matrix6d> covariances;
  for (const auto& [state, covariance] : solver_.poseCovariances())
    if (const auto id = keyframe_of_state_.find(state); id != keyframe_of_state_.end())
      covariances.emplace(id->second, covariance);
  return covariances;
}

std::map<PlaneId, Eigen::Matrix3d> GraphBuilder::planeCovariances() const {
  std::map<PlaneId, Eigen::Matrix3d> covariances;
  for (const auto& [state, at_anchor] : solver_.planeCovariances()) {
    const auto id = plane_of_state_.find(state);
    if (id == plane_of_state_.end()) continue;
    const PlaneNode& plane = graph_.planes.at(id->second);
    covariances.emplace(plane.id, alongNormal(movedCovariance(at_anchor, plane.normal_map, plane.anchor_map,
                                                              plane.centroid_map)));
  }
  return covariances;
}

std::map<std::string, FactorStatistics> GraphBuilder::statistics() const {
  std::map<std::string, FactorStatistics> statistics;
  for (const char* kind :
       {"odometry", "neighbour", "loop", "up", "observes", "plane_up", "faces", "same_height", "room_wall",
        "room_wall_infinite", "room_shape", "floor_wall", "floor_height", "floor_room"})
    statistics[kind] = {};
  for (const auto& [id, registered] : factors_) {
    FactorStatistics& kind = statistics[registered.kind];
    kind.count += 1;
    kind.dof += solver_.numResiduals(registered.factor);
    kind.chi2 += solver_.chi2(registered.factor);
  }
  return statistics;
}

}  // namespace sgraphs
