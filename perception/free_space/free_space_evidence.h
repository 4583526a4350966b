#pragma once

#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "common/types/map_update.h"
#include "perception/free_space/evidence_config.h"
#include "perception/free_space/keyframe_rays.h"
#include "perception/free_space/ray_caster.h"
#include "perception/free_space/storey_map.h"
#include "perception/free_space/surface_height.h"

namespace sgraphs {

// Free space of all storeys, tied to the keyframes: what a keyframe contributed moves with it.
class FreeSpaceEvidence {
 public:
  explicit FreeSpaceEvidence(const EvidenceConfig& config, double slice_m = kSlice_m);

  // Takes the round's keyframe, if it had one, and what its map changed; the storeys whose grids changed.
  std::vector<FloorId> step(const std::optional<Keyframe>& keyframe, const MapUpdate& update);
  // The votes alone: grids and clearance stay as they are until the next step().
  void take(const std::optional<Keyframe>& keyframe, const MapUpdate& update);

  const std::map<FloorId, StoreyMap>& storeys() const { return storeys_; }
  size_t numKeyframes() const { return views_.size(); }
  size_t bytes() const;

 private:
  // What is needed to take a keyframe's contribution back, and to make it anew elsewhere.
  struct KeyframeState {
    KeyframeRays rays;
    std::optional<double> body_height_m;  // over the walking surface
    SE3 T_map_body;                       // newest
    FloorId floor;
    bool added = false;
    SE3 T_map_body_added;  // of the contribution
    FloorId floor_added;
  };
  using Place = std::tuple<FloorId, int, int>;  // square metre of the floor

  void arrive(const Keyframe& keyframe, const MapUpdate& update);
  void settle(KeyframeId id);
  void apply(KeyframeId id, KeyframeState& state, int sign);
  bool hasMoved(const KeyframeState& state) const;
  void thinPlace(const Place& place);
  void moveWall(const MapPlane& plane);
  void moveWalls(const std::vector<MapPlane>& planes);
  StoreyMap& storey(FloorId floor);

  EvidenceConfig config_;
  RayThinner thinner_;
  RayCaster caster_;
  SurfaceHeight surface_;
  std::optional<double> last_height_m_;
  std::map<KeyframeId, KeyframeState> views_;
  std::map<Place, std::set<KeyframeId>> places_;
  std::map<PlaneId, MapPlane> waiting_walls_;  // of storeys whose walking surface is not known yet
  std::map<PlaneId, WallTrace> walls_;         // as they were added
  std::map<FloorId, StoreyMap> storeys_;
};

}  // namespace sgraphs
