#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/performance.h"
#include "common/types/free_space.h"
#include "common/types/map_update.h"
#include "common/types/rooms.h"
#include "lcmtypes/convert/chunks.h"
#include "perception/stage/map_update_input.h"
#include "perception/stage/stage_io.h"

namespace sgraphs {

// Rooms on a bus: SESSION, GRAPH_UPDATE, FREE_SPACE, STREAM_END, RUN_RESULT in; ROOMS out. One ROOMS per
// round of which FREE_SPACE came, in order of rounds. If SESSION does not list the stage "rooms", nothing is
// said.
class RoomsNode {
 public:
  using Step = std::function<Rooms(const FreeSpace&, const MapUpdate&)>;

  // The bus must outlive the node.
  RoomsNode(Bus& bus, Step step);

  void publishStatus();
  // Ends a run whose RUN_RESULT does not come.
  void finish() { io_.close(); }
  bool done() const { return io_.closed(); }
  bool streamEnded() const { return stream_ended_; }

  const InputGate& gate() const { return io_.gate(); }
  const LatencyHistogram& stepLatency() const { return latency_; }

 private:
  void onGraphUpdate(const graph_update_t& m);
  void onFreeSpace(const free_space_t& m);
  void advance();
  void work(const MapUpdate& update);

  StageIo io_;
  Step step_;
  MapUpdateInput map_updates_{io_};
  RoundAssembly<free_space_t> free_space_assembly_;
  std::deque<MapUpdate> updates_;                          // not yet worked on
  std::deque<std::vector<free_space_t>> free_space_held_;  // of rounds whose GRAPH_UPDATE has not come
  FreeSpace free_space_;
  std::string free_space_why_not_;
  Time newest_time_;
  bool stream_ended_ = false;
  LatencyHistogram latency_;
};

}  // namespace sgraphs
