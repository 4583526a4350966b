#include "backend/round_feedback.h"

#include <utility>

#include "common/bus/channels.h"
#include "lcmtypes/convert/convert_layers.h"

namespace sgraphs {
namespace {

// All chunks, once the last has come.
template <typename Message>
std::optional<std::vector<Message>> assemble(RoundAssembly<Message>& assembly, const Message& m,
                                             int64_t rounds, bool& refused) {
  auto chunks = assembly.add(m, refused);
  refused = refused || m.round >= rounds;
  return refused ? std::nullopt : std::move(chunks);
}

template <typename Message, typename Content>
RoundFeedback::Fate read(RoundAssembly<Message>& assembly, const Message& m, int64_t rounds,
                         std::map<int64_t, Content>& held) {
  bool refused = false;
  const auto chunks = assemble(assembly, m, rounds, refused);
  if (refused) return RoundFeedback::Fate::kRefused;
  if (!chunks) return RoundFeedback::Fate::kIncomplete;
  std::optional<Content> content = fromMessages(*chunks);
  if (!content) return RoundFeedback::Fate::kUnreadable;
  held[m.round] = std::move(*content);
  return RoundFeedback::Fate::kComplete;
}

template <typename T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

RoundFeedback::Fate RoundFeedback::add(const free_space_t& m, int64_t rounds) {
  bool refused = false;
  auto chunks = assemble(free_space_assembly_, m, rounds, refused);
  if (refused) return Fate::kRefused;
  if (!chunks) return Fate::kIncomplete;
  free_space_held_[m.round] = std::move(*chunks);
  return Fate::kComplete;
}

RoundFeedback::Fate RoundFeedback::add(const rooms_t& m, int64_t rounds) {
  const Fate fate = read(rooms_assembly_, m, rounds, rooms_held_);
  if (fate == Fate::kComplete) rooms_why_not_ = m.why_not;
  return fate;
}

RoundFeedback::Fate RoundFeedback::add(const loop_closures_t& m, int64_t rounds) {
  const Fate fate = read(loops_assembly_, m, rounds, loops_held_);
  if (fate == Fate::kComplete) loops_why_not_ = m.why_not;
  return fate;
}

void RoundFeedback::drop(const std::string& channel, int64_t round) {
  if (channel == channels::kFreeSpace.name) free_space_held_.erase(round);
  if (channel == channels::kRooms.name) rooms_held_.erase(round);
  if (channel == channels::kLoopClosures.name) loops_held_.erase(round);
}

bool RoundFeedback::take(const std::string& channel, int64_t round) {
  if (channel == channels::kFreeSpace.name) {
    auto next = std::make_shared<FreeSpace>(free_space_ ? *free_space_ : FreeSpace{});
    const bool sound = applyMessages(free_space_held_.at(round), *next);
    if (sound) free_space_ = std::move(next);
    free_space_held_.erase(round);
    return sound;
  }
  if (channel == channels::kRooms.name) {
    rooms_ = std::move(rooms_held_.at(round));
    rooms_held_.erase(round);
  } else if (channel == channels::kLoopClosures.name) {
    LoopClosures loops = std::move(loops_held_.at(round));
    loops_held_.erase(round);
    searching_ = loops.searching;
    if (loops_) {
      append(loops_->accepted, loops.accepted);
      append(loops_->withdrawn, loops.withdrawn);
      loops_->round = loops.round;
      loops_->time = loops.time;
    } else {
      loops_ = std::move(loops);
    }
  }
  return true;
}

std::optional<Rooms> RoundFeedback::handOutRooms() {
  return std::exchange(rooms_, std::nullopt);
}

std::optional<LoopClosures> RoundFeedback::handOutLoops() {
  return std::exchange(loops_, std::nullopt);
}

std::vector<std::string> RoundFeedback::whyNot() const {
  return {rooms_why_not_, loops_why_not_};
}

}  // namespace sgraphs
