#include "perception/free_space/free_space_evidence.h"

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

constexpr double kFar_m = 8.0;  // where a turn of the keyframe is felt: most rays are shorter

}  // namespace

FreeSpaceEvidence::FreeSpaceEvidence(const EvidenceConfig& config, double slice_m)
    : config_(config),
      thinner_(config.cell_m, config.max_range_m),
      caster_(config.cell_m, config.max_range_m, slice_m) {}

StoreyMap& FreeSpaceEvidence::storey(FloorId floor) {
  return storeys_.try_emplace(floor, floor, config_).first->second;
}

// A keyframe's pose is part of the update of its own round.
void FreeSpaceEvidence::arrive(const Keyframe& keyframe, const MapUpdate& update) {
  SE3 T_map_body = keyframe.T_odom_body;
  for (const MapKeyframe& k : update.keyframes)
    if (k.id == keyframe.id) T_map_body = k.T_map_body;
  KeyframeState& state = views_[keyframe.id];
  if (state.added) apply(keyframe.id, state, -1);
  state = KeyframeState{};
  state.T_map_body = T_map_body;
  state.body_height_m = surface_.step(keyframe, T_map_body);
  state.rays = thinner_.thin(keyframe, state.body_height_m);
  if (!state.body_height_m || last_height_m_) {
    if (state.body_height_m) last_height_m_ = state.body_height_m;
    return;
  }
  // The first floor ever seen: keyframes that came before it stood on it, too.
  last_height_m_ = state.body_height_m;
  std::vector<KeyframeId> waiting;
  for (auto& [id, other] : views_) {
    if (other.body_height_m) continue;
    other.body_height_m = last_height_m_;
    waiting.push_back(id);
  }
  for (const KeyframeId id : waiting) settle(id);
}

bool FreeSpaceEvidence::hasMoved(const KeyframeState& state) const {
  const SE3 motion = state.T_map_body_added.inverse() * state.T_map_body;
  const double moved_m = motion.translation.norm() + kFar_m * so3Log(motion.rotation).norm();
  return moved_m > 0.5 * config_.cell_m;
}

void FreeSpaceEvidence::apply(KeyframeId id, KeyframeState& state, int sign) {
  if (sign > 0) {
    state.T_map_body_added = state.T_map_body;
    state.floor_added = state.floor;
  }
  const SE3& T_map_body = state.T_map_body_added;
  const double surface_z_m = T_map_body.translation.z() - *state.body_height_m;
  storey(state.floor_added).add(caster_.cast(state.rays, T_map_body, surface_z_m), surface_z_m, sign);
  state.added = sign > 0;
  const Place place{state.floor_added, static_cast<int>(std::floor(T_map_body.translation.x())),
                    static_cast<int>(std::floor(T_map_body.translation.y()))};
  std::set<KeyframeId>& here = places_[place];
  if (sign > 0) {
    here.insert(id);
    thinPlace(place);
  } else {
    here.erase(id);
    if (here.empty()) places_.erase(place);
  }
}

// The oldest keyframe of a crowded place is given up, with its contribution.
void FreeSpaceEvidence::thinPlace(const Place& place) {
  const std::set<KeyframeId>& here = places_[place];
  if (here.size() <= static_cast<size_t>(config_.keyframes_per_place)) return;
  const KeyframeId oldest = *here.begin();
  apply(oldest, views_.at(oldest), -1);
  views_.erase(oldest);
}

// Brings a keyframe's contribution to where the keyframe is now.
void FreeSpaceEvidence::settle(KeyframeId id) {
  const auto it = views_.find(id);
  if (it == views_.end()) return;
  KeyframeState& state = it->second;
  const bool wanted = state.floor.valid() && state.body_height_m && state.T_map_body.isFinite() &&
                      storey(state.floor).reaches(state.T_map_body.translation.head<2>());
  if (state.added && (!wanted || state.floor != state.floor_added || hasMoved(state))) apply(id, state, -1);
  if (wanted && !state.added) apply(id, state, +1);
}

void FreeSpaceEvidence::moveWall(const MapPlane& plane) {
  std::optional<WallTrace> trace;
  const auto map = storeys_.find(plane.floor);
  if (map != storeys_.end() && map->second.knowsSurface())
    trace = wallTrace(plane, map->second.surface_z_m() + config_.min_wall_top_m, config_);
  const auto it = walls_.find(plane.id);
  if (it != walls_.end()) {
    if (trace && trace->near(it->second, 0.25 * config_.cell_m)) return;
    storey(it->second.floor).addWall(it->second, -1);
    walls_.erase(it);
  }
  if (!trace) return;
  storey(trace->floor).addWall(*trace, +1);
  walls_.emplace(plane.id, std::move(*trace));
}

void FreeSpaceEvidence::moveWalls(const std::vector<MapPlane>& planes) {
  std::map<PlaneId, MapPlane> moved;
  moved.swap(waiting_walls_);
  for (const MapPlane& plane : planes) moved.insert_or_assign(plane.id, plane);
  for (const auto& [id, plane] : moved) {
    const auto map = storeys_.find(plane.floor);
    const bool waits = plane.floor.valid() && !plane.merged_into.valid() &&
                       (map == storeys_.end() || !map->second.knowsSurface());
    if (waits) waiting_walls_.emplace(id, plane);
    moveWall(plane);
  }
}

void FreeSpaceEvidence::take(const std::optional<Keyframe>& keyframe, const MapUpdate& update) {
  if (keyframe) arrive(*keyframe, update);
  for (const MapKeyframe& k : update.keyframes) {
    const auto it = views_.find(k.id);
    if (it == views_.end()) continue;
    it->second.T_map_body = k.T_map_body;
    it->second.floor = k.floor;
    settle(k.id);
  }
  moveWalls(update.planes);
}

std::vector<FloorId> FreeSpaceEvidence::step(const std::optional<Keyframe>& keyframe,
                                             const MapUpdate& update) {
  take(keyframe, update);
  std::vector<FloorId> changed;
  for (auto& [floor, map] : storeys_)
    if (map.refresh()) changed.push_back(floor);
  return changed;
}

size_t FreeSpaceEvidence::bytes() const {
  size_t bytes = 0;
  for (const auto& [id, state] : views_) bytes += sizeof(state) + state.rays.bytes();
  for (const auto& [floor, map] : storeys_) bytes += map.bytes();
  return bytes;
}

}  // namespace sgraphs
