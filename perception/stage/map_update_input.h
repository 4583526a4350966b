#pragma once

#include <optional>

#include "common/types/map_update.h"
#include "lcmtypes/convert/chunks.h"
#include "perception/stage/stage_io.h"

namespace sgraphs {

// GRAPH_UPDATE as a stage hears it: the chunks of a round become what the round changed.
class MapUpdateInput {
 public:
  explicit MapUpdateInput(StageIo& io) : io_(io) {}

  // The update, once its last chunk has come. What cannot be is rejected and counted; a stage that takes no
  // part hears nothing.
  std::optional<MapUpdate> add(const graph_update_t& m);

 private:
  StageIo& io_;
  RoundAssembly<graph_update_t> assembly_;
};

}  // namespace sgraphs
