#include "perception/loops/loop_search.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "perception/loops/place_walls.h"

namespace sgraphs {
namespace {

constexpr double kDistortion_m = 3.0;  // of path on which a cloud's surroundings bend
constexpr double kSeenFrom_m = 4.0;    // from where an old place can tell what stands here

double across(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).head<2>().norm();
}

// The newest places in the frame of the newest one's body.
std::vector<PlacedPlace> queryOf(KeyframeId keyframe, const PlaceMemory& memory, const WalkedPath& path,
                                 double path_m) {
  std::vector<PlacedPlace> out;
  const SE3 T_newest_odom = path.odometryOf(keyframe).inverse();
  for (const Place* place : memory.newestBefore(keyframe, path_m, path))
    out.push_back({place, T_newest_odom * path.odometryOf(place->id)});
  return out;
}

}  // namespace

LoopSearch::OldPlaces LoopSearch::oldPlaces(KeyframeId keyframe, const PlaceMemory& memory,
                                            const WalkedPath& path) const {
  const FloorId floor = memory.poseOf(keyframe).floor;
  OldPlaces old;
  for (const auto& [id, place] : memory.places()) {
    if (path.walkedTo(keyframe) - path.walkedTo(id) < config_.gate.min_walked_m) break;
    // Storeys look alike; only stairs lead from one to the other.
    if (memory.known(id) && memory.poseOf(id).floor == floor)
      old.push_back({id, &place, memory.poseOf(id).T_map_body});
  }
  return old;
}

LoopSearch::Anchors LoopSearch::anchorsOf(KeyframeId keyframe, const OldPlaces& old,
                                          const PlaceMemory& memory, const WalkedPath& path) const {
  const MapKeyframe& here = memory.poseOf(keyframe);
  const WalkedPath::Gates gates = path.gatesFrom(keyframe);
  std::vector<Anchor> anchors;
  for (const OldPlace& there : old) {
    if (std::abs((there.T_map_body.translation - here.T_map_body.translation).z()) > config_.gate.height_m)
      continue;
    const LoopGate gate = gates.at(there.id);
    if (across(there.T_map_body.translation, here.T_map_body.translation) > gate.radius_m + kAnchorReach_m)
      continue;
    anchors.push_back({there.id, there.T_map_body, gate});
  }
  return anchors;
}

OldSurroundings LoopSearch::surroundingsOf(const Anchor& anchor, const OldPlaces& old,
                                           const WalkedPath& path) const {
  const SE3 T_anchor_map = anchor.T_map_body.inverse();
  std::vector<PlacedPlace> places;
  for (const OldPlace& there : old) {
    if (std::abs(path.walkedTo(there.id) - path.walkedTo(anchor.id)) > config_.verification.submap_path_m)
      continue;
    const SE3 T_anchor_body = T_anchor_map * there.T_map_body;
    if (T_anchor_body.translation.norm() > config_.verification.submap_radius_m) continue;
    places.push_back({there.place, T_anchor_body});
  }
  return OldSurroundings::ofNearest(std::move(places));
}

LoopHypothesis LoopSearch::measured(const std::vector<PlacedPlace>& query, const OldSurroundings& around,
                                    const MeasuredLoop& guess, const WalkedPath& path) const {
  LoopHypothesis h;
  h.check = checkLoop(query, around, guess.T_from_to, config_.verification);
  h.loop = {guess.from, guess.to, h.check.T_anchor_body,
            h.check.covariance + path.distortionAt(guess.from, kDistortion_m) +
                path.distortionAt(guess.to, kDistortion_m)};
  return h;
}

std::optional<LoopHypothesis> LoopSearch::straightAcross(KeyframeId keyframe, FloorId floor,
                                                         const PlaceMemory& memory,
                                                         const WalkedPath& path) const {
  OldPlaces old;
  for (const auto& [id, place] : memory.places()) {
    if (path.ridesBefore(id) == path.ridesBefore(keyframe)) break;
    if (memory.known(id) && memory.poseOf(id).floor == floor)
      old.push_back({id, &place, memory.poseOf(id).T_map_body});
  }
  const SE3& T_map_body = memory.poseOf(keyframe).T_map_body;
  const OldPlace* nearest = nearestFromAbove(old, T_map_body.translation.head<2>(), kAnchorReach_m);
  if (!nearest) return std::nullopt;
  const OldSurroundings around = surroundingsOf({nearest->id, nearest->T_map_body, {}}, old, path);
  SE3 T_map_guess = T_map_body;
  T_map_guess.translation.z() = nearest->T_map_body.translation.z();
  LoopHypothesis h = measured(queryOf(keyframe, memory, path, config_.verification.query_path_m), around,
                              {nearest->id, keyframe, nearest->T_map_body.inverse() * T_map_guess}, path);
  const SE3 T_guess_found = T_map_guess.inverse() * nearest->T_map_body * h.check.T_anchor_body;
  h.correction_m = T_guess_found.translation.norm();
  return h;
}

LoopVerdict LoopSearch::step(KeyframeId keyframe, const PlaceMemory& memory, const WalkedPath& path) const {
  LoopVerdict verdict;
  verdict.keyframe = keyframe;
  const OldPlaces old = oldPlaces(keyframe, memory, path);
  const Anchors anchors = anchorsOf(keyframe, old, memory, path);
  if (anchors.empty()) return verdict;
  const SE3 T_map_body = memory.poseOf(keyframe).T_map_body;
  LayoutSearch where;
  where.centre_map = T_map_body.translation.head<2>();
  where.max_matches = config_.verification.max_hypotheses;
  where.yaw_range_rad = 0;
  for (const Anchor& a : anchors) {
    where.radius_m = std::max(where.radius_m, a.gate.radius_m);
    where.yaw_range_rad = std::max(where.yaw_range_rad, a.gate.yaw_rad);
  }
  WallLayout layout(where.centre_map, where.radius_m + kQueryReach_m);
  std::vector<PlacedPlace> around_here;
  for (const OldPlace& there : old)
    if (across(there.T_map_body.translation, T_map_body.translation) < where.radius_m + 2 * kQueryReach_m)
      around_here.push_back({there.place, there.T_map_body});
  for (const WallPoint& w : wallsOf(around_here)) layout.add(w);

  const std::vector<PlacedPlace> query = queryOf(keyframe, memory, path, config_.verification.query_path_m);
  std::map<KeyframeId, OldSurroundings> surroundings;
  for (const LayoutMatch& match : layout.search(wallsAround(query, T_map_body.rotation), where)) {
    const Anchor* anchor = nearestFromAbove(anchors, match.position_map, kAnchorReach_m);
    if (!anchor || (match.position_map - where.centre_map).norm() > anchor->gate.radius_m ||
        std::abs(match.yaw_rad) > anchor->gate.yaw_rad + 0.05)
      continue;
    auto it = surroundings.find(anchor->id);
    if (it == surroundings.end())
      it = surroundings.emplace(anchor->id, surroundingsOf(*anchor, old, path)).first;
    // A body is carried at one height above the floor.
    const SE3 T_map_guess(
        so3Exp({0, 0, match.yaw_rad}) * T_map_body.rotation,
        {match.position_map.x(), match.position_map.y(), anchor->T_map_body.translation.z()});
    LoopHypothesis h =
        measured(query, it->second, {anchor->id, keyframe, anchor->T_map_body.inverse() * T_map_guess}, path);
    ++verdict.registrations;
    const SE3 T_map_found = anchor->T_map_body * h.check.T_anchor_body;
    h.correction_m = (T_map_found.translation - T_map_body.translation).norm();
    h.gate_m = anchor->gate.radius_m;
    verdict.hypotheses.push_back(h);
  }
  std::stable_sort(
      verdict.hypotheses.begin(), verdict.hypotheses.end(),
      [](const LoopHypothesis& a, const LoopHypothesis& b) { return a.check.quality() > b.check.quality(); });
  std::vector<LoopHypothesis> kept;
  for (const LoopHypothesis& h : verdict.hypotheses) {
    const SE3 T_map_found = memory.poseOf(h.loop.from).T_map_body * h.loop.T_from_to;
    if (std::all_of(kept.begin(), kept.end(), [&](const LoopHypothesis& k) {
          return areDistinct(memory.poseOf(k.loop.from).T_map_body * k.loop.T_from_to, T_map_found);
        }))
      kept.push_back(h);
  }
  verdict.hypotheses = std::move(kept);
  if (!verdict.hypotheses.empty() && verdict.hypotheses.front().correction_m > kDistinct_m) {
    if (const Anchor* anchor = nearestFromAbove(anchors, where.centre_map, kSeenFrom_m)) {
      const OldSurroundings around = surroundingsOf(*anchor, old, path);
      const LoopCheck stays =
          checkLoop(query, around, anchor->T_map_body.inverse() * T_map_body, config_.verification);
      verdict.map_refuted = stays.refuted(config_.verification);
      ++verdict.registrations;
    }
  }
  return verdict;
}

}  // namespace sgraphs
