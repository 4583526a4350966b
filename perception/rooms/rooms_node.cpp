#include "perception/rooms/rooms_node.h"

#include <algorithm>
#include <utility>

#include "lcmtypes/convert/convert_layers.h"

namespace sgraphs {
namespace {

// Free space answers a GRAPH_UPDATE that this stage hears as well; either may come first.
constexpr size_t kMaxHeld = 100;

}  // namespace

RoomsNode::RoomsNode(Bus& bus, Step step) : io_(bus, "rooms", "sgraphs-rooms"), step_(std::move(step)) {
  io_.listen(channels::kGraphUpdate, [this](const graph_update_t& m) { onGraphUpdate(m); });
  io_.listen(channels::kFreeSpace, [this](const free_space_t& m) { onFreeSpace(m); });
  io_.listen(channels::kStreamEnd, [this](const stream_end_t& m) {
    stream_ended_ = io_.accept(channels::kStreamEnd, m) || stream_ended_;
  });
  io_.listen(channels::kRunResult, [this](const run_result_t& m) {
    if (io_.accept(channels::kRunResult, m)) io_.close();
  });
}

void RoomsNode::onGraphUpdate(const graph_update_t& m) {
  std::optional<MapUpdate> update = map_updates_.add(m);
  if (!update) return;
  updates_.push_back(std::move(*update));
  advance();
}

void RoomsNode::onFreeSpace(const free_space_t& m) {
  if (!io_.accept(channels::kFreeSpace, m) || !io_.takesPart()) return;
  bool refused = false;
  auto chunks = free_space_assembly_.add(m, refused);
  if (refused || free_space_held_.size() >= kMaxHeld)
    return io_.reject(channels::kFreeSpace, "a round that cannot be, or chunks that do not match");
  if (!chunks) return;
  free_space_why_not_ = m.why_not;
  free_space_held_.push_back(std::move(*chunks));
  advance();
}

// A GRAPH_UPDATE waits for the free space of its round, or of a later one: then its own is lost.
void RoomsNode::advance() {
  while (!updates_.empty() && !free_space_held_.empty()) {
    const int64_t held = free_space_held_.front().front().round;
    if (held > updates_.front().round) {
      work(updates_.front());
      updates_.pop_front();
      continue;
    }
    const bool answers = held == updates_.front().round;
    if (!applyMessages(free_space_held_.front(), free_space_))
      io_.reject(channels::kFreeSpace, "content that cannot be right");
    free_space_held_.pop_front();
    if (!answers) continue;
    work(updates_.front());
    updates_.pop_front();
  }
}

void RoomsNode::work(const MapUpdate& update) {
  newest_time_ = std::max(newest_time_, update.time);
  const Stopwatch watch;
  const Rooms rooms = step_(free_space_, update);
  latency_.add(watch.elapsedUs());
  std::string why_not = io_.gate().trouble();
  if (!free_space_why_not_.empty()) why_not += (why_not.empty() ? "" : "; ") + free_space_why_not_;
  for (rooms_t& m : toMessages(rooms, why_not)) io_.send(channels::kRooms, m);
}

void RoomsNode::publishStatus() {
  io_.publishStatus(channels::kStatusRooms, newest_time_, updates_.size() + free_space_held_.size(),
                    latency_);
}

}  // namespace sgraphs
