#include "perception/free_space/free_space_mapper.h"

namespace sgraphs {

const FreeSpace& FreeSpaceMapper::step(const std::optional<Keyframe>& keyframe, const MapUpdate& update) {
  const std::vector<FloorId> changed = evidence_.step(keyframe, update);
  for (const FloorId floor : changed) {
    const StoreyMap& storey = evidence_.storeys().at(floor);
    graph_.update(storey.rooms(), storey.navigation());
  }
  if (!changed.empty()) result_ = graph_.result();
  result_.round = update.round;
  result_.time = update.time;
  return result_;
}

}  // namespace sgraphs
