#include "backend/planes/plane_layer.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "backend/planes/plane_extent.h"
#include "backend/planes/plane_pairs.h"
#include "backend/planes/plane_residual.h"
#include "backend/planes/shared_information.h"

namespace sgraphs {
namespace {

// A plane that was last seen so many keyframes ago closes a circle when it is seen again.
constexpr int64_t kCircleSpan = 20;
// So many keyframes must take two planes for one before they are merged.
constexpr int kTwinKeyframes = 3;
// Planes within this of level or plumb are taken for it.
constexpr double kUprightWithin_rad = 0.07;
// A plane is announced again when it changed by more than this.
constexpr double kPlaneAnnounceStep_m = 1e-3;
constexpr double kPlaneAnnounceStep_rad = 1e-4;
constexpr size_t kMaxUnmapped = 500;
// An observation is of another plane than it was taken for if it is off by this (chi-square with 3 degrees of
// freedom): ten times what walls depart from planes and what it is known to.
constexpr double kMisfitChi2 = 100;
// What keyframes that follow each other err by where no wall has been solved for yet.
constexpr double kRoughly_m = 0.1, kRoughly_rad = 0.05;
// Covariances are first-order, about states that still move a little.
constexpr double kPlaneCovarianceMargin = 1.02;

// Metres and radians that a solver can work with: the ranges of keyframe_admission, and no sight beyond 1 km.
bool canBeWeighed(const PlaneObservation& z) {
  constexpr double kFar_m = 1000, kLeastVariance = 1e-14, kMostVariance = 1e4, kMaxRatio = 1e12;
  if (!(z.centroid_body.norm() < kFar_m) || !z.covariance.allFinite()) return false;
  for (const Eigen::Vector2f& corner : z.boundary)
    if (!(corner.norm() < kFar_m)) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(z.covariance, Eigen::EigenvaluesOnly);
  const double least = eigen.eigenvalues()(0), most = eigen.eigenvalues()(2);
  return least > kLeastVariance && most < std::min(kMostVariance, kMaxRatio * least);
}

PlaneNode planeFrom(const PlaneObservation& z, const SE3& T_map_body, FloorId floor) {
  PlaneNode plane;
  plane.floor = floor;
  plane.normal_map = T_map_body.rotation * z.normal_body;
  plane.anchor_map = T_map_body * z.centroid_body;
  setExtent(plane, extentOn(plane, z, T_map_body));
  return plane;
}

Eigen::Matrix3d atAnchor(const PlaneObservation& z, const SE3& T_map_body, const PlaneNode& plane) {
  return movedCovariance(observedPlaneCovariance(z, T_map_body, Matrix6d::Zero()), plane.normal_map,
                         T_map_body * z.centroid_body, plane.anchor_map);
}

}  // namespace

void PlaneLayer::advance(const RelativePose& z) {
  const auto age = [&z](Track& track) {
    track.drift = composeCovariance(track.drift, z.T_from_to, z.covariance);
  };
  const auto reframe = [](Track& track, const Eigen::Vector3d& normal_map) {
    track.covariance = reframedCovariance(track.covariance, track.normal_map, normal_map);
    track.normal_map = normal_map;
  };
  const SituationalGraph& graph = builder_.graph();
  for (auto& [id, track] : tracks_) {
    age(track);
    reframe(track, graph.planes.at(id).normal_map);
  }
  for (Unmapped& unmapped : unmapped_) {
    age(unmapped.track);
    const KeyframeNode& seen_from = graph.keyframes.at(unmapped.keyframe);
    unmapped.plane = planeFrom(unmapped.z, seen_from.T_map_body, seen_from.floor);
    reframe(unmapped.track, unmapped.plane.normal_map);
  }
}

void PlaneLayer::carriedTo(const std::map<KeyframeId, Matrix6d>& there) {
  const auto age = [&](Track& track) {
    if (const auto way = there.find(track.last_seen); way != there.end()) track.drift = way->second;
  };
  for (auto& [id, track] : tracks_) age(track);
  for (Unmapped& unmapped : unmapped_) age(unmapped.track);
}

PlaneLayer::Known PlaneLayer::candidates(FloorId floor) const {
  Known known;
  size_t index = 0;
  const auto add = [&](const PlaneNode& plane, const Track& track) {
    const bool apart = plane.floor.valid() && floor.valid() && plane.floor != floor;
    const bool ridden = track.drift(2, 2) > kOpenHeight_m * kOpenHeight_m;
    if (!apart && !ridden) {
      known.planes.push_back({&plane, track.covariance, track.drift});
      known.index.push_back(index);
    }
    ++index;
  };
  for (const auto& [id, track] : tracks_) add(builder_.graph().planes.at(id), track);
  for (const Unmapped& unmapped : unmapped_) add(unmapped.plane, unmapped.track);
  return known;
}

PlaneLayer::Sighting PlaneLayer::associate(KeyframeId keyframe, const KeyframePlanes& planes) const {
  const KeyframeNode& node = builder_.graph().keyframes.at(keyframe);
  const SE3& T_map_body = node.T_map_body;
  const Known known = candidates(node.floor);
  Sighting sighting;
  sighting.observations = planes.planes;
  sighting.candidate = associatePlanes(planes.planes, T_map_body, known.planes, config_.gate);
  keepSharedError(planes.pose_sigma, sighting.observations);
  for (size_t i = 0; i < sighting.observations.size(); ++i) {
    if (canBeWeighed(sighting.observations[i])) continue;
    sighting.refused.push_back("plane " + std::to_string(i) + " of keyframe " + keyframe.str() +
                               ": its place, extent or covariance is out of range");
    sighting.observations[i].area_m2 = 0;  // never mapped
    sighting.candidate[i].reset();
  }
  sighting.information.setZero();
  for (size_t i = 0; i < sighting.observations.size(); ++i) {
    auto& candidate = sighting.candidate[i];
    if (!candidate) continue;
    const PlaneNode& plane = *known.planes[*candidate].plane;
    candidate = known.index[*candidate];
    if (*candidate >= tracks_.size()) continue;
    const PlaneResidual r = planeResidual(sighting.observations[i], T_map_body, plane);
    sighting.information += r.by_pose.transpose() * sighting.observations[i].covariance.inverse() * r.by_pose;
  }
  return sighting;
}

bool PlaneLayer::add(KeyframeId keyframe, const Sighting& sighting) {
  const KeyframeNode& node = builder_.graph().keyframes.at(keyframe);
  seen_.clear();
  bool circle = false;
  std::vector<PlaneId> mapped;
  for (const auto& [id, track] : tracks_) mapped.push_back(id);
  const size_t num_mapped = mapped.size();
  std::map<size_t, PlaneId> just_mapped;  // index into unmapped_ -> its plane
  std::vector<Unmapped> fresh;
  for (size_t i = 0; i < sighting.observations.size(); ++i) {
    const PlaneObservation& z = sighting.observations[i];
    const auto& candidate = sighting.candidate[i];
    if (!candidate) {
      if (!(z.area_m2 >= config_.min_area_m2) || z.area_m2 <= 0) continue;
      const PlaneNode plane = planeFrom(z, node.T_map_body, node.floor);
      fresh.push_back({keyframe,
                       z,
                       plane,
                       {atAnchor(z, node.T_map_body, plane), plane.normal_map, Matrix6d::Zero(), keyframe}});
      continue;
    }
    if (*candidate < num_mapped) {
      const PlaneId plane = mapped[*candidate];
      circle = circle || keyframe.value - tracks_.at(plane).last_seen.value > kCircleSpan;
      observe(keyframe, plane, z, tracks_.at(plane));
      continue;
    }
    const size_t index = *candidate - num_mapped;
    if (!just_mapped.contains(index)) {
      map(unmapped_[index]);
      just_mapped[index] = builder_.graph().planes.rbegin()->first;
    }
    observe(keyframe, just_mapped[index], z, tracks_.at(just_mapped[index]));
  }
  std::vector<Unmapped> rest;
  for (size_t i = 0; i < unmapped_.size(); ++i)
    if (!just_mapped.contains(i)) rest.push_back(std::move(unmapped_[i]));
  rest.insert(rest.end(), fresh.begin(), fresh.end());
  unmapped_ = std::move(rest);
  addUprights();
  forgetOld(keyframe);
  return circle;
}

void PlaneLayer::map(const Unmapped& unmapped) {
  const KeyframeNode& node = builder_.graph().keyframes.at(unmapped.keyframe);
  const SE3& T_map_body = node.T_map_body;
  PlaneNode plane = planeFrom(unmapped.z, T_map_body, node.floor);
  plane.label = axes_.label(plane.normal_map, builder_.graph().up_map);
  plane.covariance = alongNormal(
      movedCovariance(observedPlaneCovariance(unmapped.z, T_map_body,
                                              builder_.graph().keyframes.at(unmapped.keyframe).covariance),
                      plane.normal_map, plane.anchor_map, plane.centroid_map));
  const PlaneId id = builder_.addPlane(std::move(plane));
  tracks_[id] = unmapped.track;
  builder_.addObservation(unmapped.keyframe, id, unmapped.z);
  upright_unknown_.insert(id);
}

// What was known of the plane, made older by the drift, and the new sight of it, fused.
void PlaneLayer::observe(KeyframeId keyframe, PlaneId id, const PlaneObservation& z, Track& track) {
  const SE3& T_map_body = builder_.graph().keyframes.at(keyframe).T_map_body;
  const PlaneNode& plane = builder_.graph().planes.at(id);
  const PlaneResidual r = planeResidual(z, T_map_body, plane);
  const Eigen::Matrix3d A = r.by_plane.inverse();
  const Eigen::Matrix3d seen = A * z.covariance * A.transpose();
  const Eigen::Matrix3d drift = A * r.by_pose * track.drift * r.by_pose.transpose() * A.transpose();
  track.covariance = ((track.covariance + drift).inverse() + seen.inverse()).inverse();
  track.covariance = 0.5 * (track.covariance + track.covariance.transpose()).eval();
  track.drift.setZero();
  track.last_seen = keyframe;

  builder_.addObservation(keyframe, id, z);
  Polygon2d extent = extentOf(plane);
  const Polygon2d more = extentOn(plane, z, T_map_body);
  extent.insert(extent.end(), more.begin(), more.end());
  builder_.setExtent(id, extent);
  seen_.push_back(id);
}

// Level planes first: they say where up is.
void PlaneLayer::addUprights() {
  const SituationalGraph& graph = builder_.graph();
  const auto alongUp = [&](PlaneId id) { return std::abs(graph.planes.at(id).normal_map.dot(graph.up_map)); };
  std::erase_if(upright_unknown_, [&](PlaneId id) { return !graph.planes.contains(id); });
  for (const PlaneId id : upright_unknown_)
    if (alongUp(id) > std::cos(kUprightWithin_rad)) builder_.addPlaneUp(id, true, config_.level_sigma_rad);
  if (!builder_.hasUp()) return;
  for (const PlaneId id : upright_unknown_)
    if (alongUp(id) < std::sin(kUprightWithin_rad)) builder_.addPlaneUp(id, false, config_.plumb_sigma_rad);
  upright_unknown_.clear();
}

void PlaneLayer::forgetOld(KeyframeId newest) {
  std::erase_if(unmapped_, [&](const Unmapped& u) {
    return newest.value - u.keyframe.value > config_.patience_keyframes;
  });
  if (unmapped_.size() > kMaxUnmapped)
    unmapped_.erase(unmapped_.begin(), unmapped_.end() - static_cast<std::ptrdiff_t>(kMaxUnmapped));
}

bool PlaneLayer::areTwins(PlaneId a, PlaneId b) const {
  const auto& planes = builder_.graph().planes;
  const double tilt_variance = tracks_.at(a).covariance.topLeftCorner<2, 2>().trace() +
                               tracks_.at(b).covariance.topLeftCorner<2, 2>().trace();
  return areOneSurface(planes.at(a), planes.at(b), config_.gate, std::sqrt(tilt_variance));
}

// Two planes of this round's sight that coincide where both were seen. In an idle round there is time to look
// at all of them, and no further evidence to wait for.
void PlaneLayer::countTwins(bool idle) {
  const auto& planes = builder_.graph().planes;
  std::vector<PlaneId> looked_at = seen_;
  if (idle || rounds_to_look_at_all_ > 0) {
    looked_at.clear();
    for (const auto& [id, track] : tracks_) looked_at.push_back(id);
  }
  std::set<std::pair<PlaneId, PlaneId>> counted;
  for (const PlaneId a : looked_at)
    for (const auto& [b, plane] : planes) {
      if (a == b || !areTwins(a, b)) continue;
      if (counted.insert(std::minmax(a, b)).second) twins_[std::minmax(a, b)] += idle ? kTwinKeyframes : 1;
    }
}

void PlaneLayer::mergeTwins() {
  for (auto it = twins_.begin(); it != twins_.end();) {
    const auto [into, from] = it->first;
    const auto& planes = builder_.graph().planes;
    if (!planes.contains(into) || !planes.contains(from)) {
      it = twins_.erase(it);
      continue;
    }
    if (it->second < kTwinKeyframes) {
      ++it;
      continue;
    }
    // An earlier merge of this round may have changed one of the two.
    if (!areTwins(into, from)) {
      it = twins_.erase(it);
      continue;
    }
    merge(from, into);
    it = twins_.erase(it);
  }
}

void PlaneLayer::merge(PlaneId from, PlaneId into) {
  // The one seen last is known relative to the newest keyframe.
  std::optional<Track> newer;
  if (tracks_.at(from).last_seen > tracks_.at(into).last_seen) {
    newer = tracks_.at(from);
    const PlaneNode &gone = builder_.graph().planes.at(from), &kept = builder_.graph().planes.at(into);
    newer->covariance = reframedCovariance(
        movedCovariance(reframedCovariance(newer->covariance, newer->normal_map, gone.normal_map),
                        gone.normal_map, gone.anchor_map, kept.anchor_map),
        gone.normal_map, kept.normal_map);
    newer->normal_map = kept.normal_map;
  }
  builder_.mergePlanes(from, into);
  if (newer) tracks_.at(into) = *newer;
  tracks_.erase(from);
  announced_.erase(from);
  merged_away_.insert(from);
  std::erase(seen_, from);
}

template <typename Factor>
bool PlaneLayer::paired(const std::vector<Factor>& factors, PlaneId a, PlaneId b) {
  return std::any_of(factors.begin(), factors.end(),
                     [&](const Factor& f) { return (f.a == a && f.b == b) || (f.a == b && f.b == a); });
}

void PlaneLayer::pairFaces(PlaneId id) {
  const SituationalGraph& graph = builder_.graph();
  for (const auto& [other, plane] : graph.planes)
    if (areFacesOfOneWall(graph.planes.at(id), plane, graph.up_map) && !paired(graph.faces, id, other))
      builder_.addFaces(std::min(id, other), std::max(id, other), config_.parallel_sigma_rad);
}

// To the oldest of its height only: pairs do not pile up.
void PlaneLayer::pairHeights(PlaneId id) {
  const SituationalGraph& graph = builder_.graph();
  if (!builder_.hasUp()) return;
  for (const auto& [other, plane] : graph.planes) {
    if (other >= id) return;
    if (!areOneHeight(graph.planes.at(id), plane, graph.up_map)) continue;
    if (!paired(graph.same_heights, id, other))
      builder_.addSameHeight(other, id, config_.same_height_sigma_m);
    return;
  }
}

void PlaneLayer::settle(bool whole, bool idle) {
  countTwins(idle);
  rounds_to_look_at_all_ = std::max(0, rounds_to_look_at_all_ - 1);
  mergeTwins();
  for (const PlaneId id : seen_) {
    pairFaces(id);
    pairHeights(id);
  }
  // Its cost is that of all observations; while the robot walks, extents grow and follow their planes.
  if (whole && idle) remakeExtents();
  axes_.update(builder_.graph().planes, builder_.graph().up_map);
  for (const auto& [id, track] : tracks_)
    builder_.setLabel(id, axes_.label(builder_.graph().planes.at(id).normal_map, builder_.graph().up_map));
  seen_.clear();
}

void PlaneLayer::remakeExtents() {
  std::map<PlaneId, Polygon2d> points;
  const SituationalGraph& graph = builder_.graph();
  for (const ObservationFactor& factor : graph.observations) {
    const Polygon2d seen = extentOn(graph.planes.at(factor.plane), factor.measurement,
                                    graph.keyframes.at(factor.keyframe).T_map_body);
    Polygon2d& all = points[factor.plane];
    all.insert(all.end(), seen.begin(), seen.end());
  }
  for (const auto& [id, extent] : points) builder_.setExtent(id, extent);
}

void PlaneLayer::mapMended(const std::map<KeyframeId, Matrix6d>& newest) {
  const auto shorten = [&](Track& track) {
    const auto way = newest.find(track.last_seen);
    if (way != newest.end() && way->second.trace() < track.drift.trace()) track.drift = way->second;
  };
  for (auto& [id, track] : tracks_) shorten(track);
  for (Unmapped& unmapped : unmapped_) shorten(unmapped.track);
  AssociationGate own = config_.gate;
  own.chi2 = kMisfitChi2;
  reassociate(own, config_.gate);
  remakeExtents();
  rounds_to_look_at_all_ = kTwinKeyframes;
}

void PlaneLayer::mapUnbent() {
  AssociationGate rough = config_.gate;
  rough.surface_m = kRoughly_m;
  rough.surface_rad = kRoughly_rad;
  reassociate(rough, rough);
}

bool PlaneLayer::fits(const ObservationFactor& factor, const PlaneNode& plane,
                      const AssociationGate& gate) const {
  const PlaneCandidate candidate{&plane, Eigen::Matrix3d::Zero(), Matrix6d::Zero()};
  const SE3& T_map_body = builder_.graph().keyframes.at(factor.keyframe).T_map_body;
  return planeDistance(factor.measurement, T_map_body, candidate, gate).has_value();
}

// The plane that the observation fits best, of those of its storey.
PlaneId PlaneLayer::planeFor(const ObservationFactor& factor, const AssociationGate& gate) const {
  const SituationalGraph& graph = builder_.graph();
  const KeyframeNode& node = graph.keyframes.at(factor.keyframe);
  PlaneId best;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [id, plane] : graph.planes) {
    if (id == factor.plane || (plane.floor.valid() && node.floor.valid() && plane.floor != node.floor))
      continue;
    const PlaneCandidate candidate{&plane, Eigen::Matrix3d::Zero(), Matrix6d::Zero()};
    const auto distance2 = planeDistance(factor.measurement, node.T_map_body, candidate, gate);
    if (!distance2 || *distance2 >= least) continue;
    least = *distance2;
    best = id;
  }
  return best;
}

// A plane keeps what founded it: at least one observation.
void PlaneLayer::reassociate(const AssociationGate& own, const AssociationGate& other) {
  const SituationalGraph& graph = builder_.graph();
  std::map<PlaneId, int64_t> left;
  for (const auto& [id, plane] : graph.planes) left[id] = plane.num_observations;
  std::set<int64_t> gone;
  std::vector<std::pair<PlaneId, ObservationFactor>> moved;
  std::vector<ObservationFactor> astray;
  for (const ObservationFactor& factor : graph.observations) {
    if (left.at(factor.plane) <= 1 || fits(factor, graph.planes.at(factor.plane), own)) continue;
    left.at(factor.plane) -= 1;
    gone.insert(factor.id);
    if (const PlaneId plane = planeFor(factor, other); plane.valid())
      moved.emplace_back(plane, factor);
    else
      astray.push_back(factor);
  }
  builder_.removeObservations(gone);
  for (const auto& [plane, factor] : moved)
    builder_.addObservation(factor.keyframe, plane, factor.measurement);
  mapApart(astray, other);
}

// Planes of their own, for those that are seen twice.
void PlaneLayer::mapApart(const std::vector<ObservationFactor>& astray, const AssociationGate& gate) {
  struct Found {
    PlaneNode plane;
    std::vector<const ObservationFactor*> seen;
  };
  const auto& keyframes = builder_.graph().keyframes;
  std::vector<Found> found;
  for (const ObservationFactor& factor : astray) {
    const KeyframeNode& node = keyframes.at(factor.keyframe);
    const auto known = std::find_if(found.begin(), found.end(), [&](const Found& f) {
      return f.plane.floor == node.floor && fits(factor, f.plane, gate);
    });
    if (known == found.end()) {
      found.push_back({planeFrom(factor.measurement, node.T_map_body, node.floor), {&factor}});
      continue;
    }
    Polygon2d extent = extentOf(known->plane);
    const Polygon2d more = extentOn(known->plane, factor.measurement, node.T_map_body);
    extent.insert(extent.end(), more.begin(), more.end());
    setExtent(known->plane, std::move(extent));
    known->seen.push_back(&factor);
  }
  for (const Found& f : found) {
    if (f.seen.size() < 2) continue;
    const ObservationFactor& newest = *f.seen.back();
    map({f.seen.front()->keyframe, f.seen.front()->measurement, f.plane, {}});
    const PlaneNode& plane = builder_.graph().planes.rbegin()->second;
    builder_.setExtent(plane.id, extentOf(f.plane));
    for (size_t i = 1; i < f.seen.size(); ++i)
      builder_.addObservation(f.seen[i]->keyframe, plane.id, f.seen[i]->measurement);
    // How old it is, mapMended() says.
    tracks_[plane.id] = {atAnchor(newest.measurement, keyframes.at(newest.keyframe).T_map_body, plane),
                         plane.normal_map, keyframes.rbegin()->second.covariance, newest.keyframe};
  }
}

void PlaneLayer::refreshCovariances() {
  for (const auto& [id, covariance] : builder_.planeCovariances())
    builder_.setCovariance(id, kPlaneCovarianceMargin * covariance);
}

std::vector<PlaneId> PlaneLayer::takeChanged() {
  std::vector<PlaneId> changed(merged_away_.begin(), merged_away_.end());
  merged_away_.clear();
  for (const auto& [id, plane] : builder_.graph().planes) {
    Announced& known = announced_[id];
    const bool still = (known.normal - plane.normal_map).norm() < kPlaneAnnounceStep_rad &&
                       std::abs(known.d - plane.d()) < kPlaneAnnounceStep_m &&
                       known.num_observations == plane.num_observations && known.floor == plane.floor;
    if (still) continue;
    known = {plane.normal_map, plane.d(), plane.num_observations, plane.floor};
    changed.push_back(id);
  }
  std::sort(changed.begin(), changed.end());
  return changed;
}

}  // namespace sgraphs
