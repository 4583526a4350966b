#pragma once

#include <optional>

#include "common/types/free_space.h"
#include "common/types/keyframe.h"
#include "common/types/map_update.h"
#include "perception/free_space/clusters/free_space_graph.h"
#include "perception/free_space/free_space_config.h"
#include "perception/free_space/free_space_evidence.h"

namespace sgraphs {

// Keyframe clouds and the optimised map become free space: evidence, clearance, clusters and a sparse graph,
// storey by storey.
class FreeSpaceMapper {
 public:
  explicit FreeSpaceMapper(const FreeSpaceConfig& config)
      : evidence_(config.evidence), graph_(config.graph) {}

  // Once per round, idle ones too, in order: the round's keyframe, if it had one and its cloud came, and what
  // the round changed of the map, that keyframe's pose among it. The result stays valid until the next call.
  const FreeSpace& step(const std::optional<Keyframe>& keyframe, const MapUpdate& update);

  const FreeSpaceEvidence& evidence() const { return evidence_; }

 private:
  FreeSpaceEvidence evidence_;
  FreeSpaceGraph graph_;
  FreeSpace result_;
};

}  // namespace sgraphs
