#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/types/free_space.h"
#include "common/types/loops.h"
#include "common/types/rooms.h"
#include "lcmtypes/convert/chunks.h"
#include "sgraphs/free_space_t.hpp"
#include "sgraphs/loop_closures_t.hpp"
#include "sgraphs/rooms_t.hpp"

namespace sgraphs {

// What the stages make of the backend's map (FREE_SPACE, ROOMS, LOOP_CLOSURES), from its chunks to what a
// round is given. Which round that is, RoundJoiner decides.
class RoundFeedback {
 public:
  enum class Fate {
    kIncomplete,  // chunks are missing still
    kComplete,    // held for take()
    kRefused,     // a round that cannot be, or chunks that do not match
    kUnreadable,  // complete, with content that cannot be right: its round goes without it
  };

  // `rounds`: number of rounds that have run; nothing can be made of later ones.
  Fate add(const free_space_t& m, int64_t rounds);
  Fate add(const rooms_t& m, int64_t rounds);
  Fate add(const loop_closures_t& m, int64_t rounds);
  // Forgets what was made of this round: it came too late.
  void drop(const std::string& channel, int64_t round);

  // It joins the next round; outputs are taken in order of rounds. False: its content cannot be right.
  bool take(const std::string& channel, int64_t round);

  // For the next round: the free space as it is now, of the rooms the newest, of the loops all that came
  // since. Rooms and loops are handed out once.
  std::shared_ptr<const FreeSpace> freeSpace() const { return free_space_; }
  std::optional<Rooms> handOutRooms();
  std::optional<LoopClosures> handOutLoops();
  // The newest loops that were taken have work left.
  bool searching() const { return searching_; }
  // What those stages missed, by their newest messages; empty: nothing.
  std::vector<std::string> whyNot() const;

 private:
  RoundAssembly<free_space_t> free_space_assembly_;
  RoundAssembly<rooms_t> rooms_assembly_;
  RoundAssembly<loop_closures_t> loops_assembly_;
  // Complete and not yet taken, by round.
  std::map<int64_t, std::vector<free_space_t>> free_space_held_;
  std::map<int64_t, Rooms> rooms_held_;
  std::map<int64_t, LoopClosures> loops_held_;
  // Taken and not yet handed out.
  std::shared_ptr<const FreeSpace> free_space_;
  std::optional<Rooms> rooms_;
  std::optional<LoopClosures> loops_;
  bool searching_ = false;
  std::string rooms_why_not_, loops_why_not_;
};

}  // namespace sgraphs
