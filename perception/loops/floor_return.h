#pragma once

#include <map>
#include <vector>

#include "perception/loops/loop_search.h"

namespace sgraphs {

// Recognises a floor to which a lift has brought the robot back. A ride leaves x, y and heading as they were,
// so that a known floor can only be straight above or below: whether it is this one is told by all that has
// been seen since the ride. Wrongly joined floors ruin the map, and floors of one building look alike, so
// much is asked for: the floor must agree over a long way and never be contradicted, and all other floors
// must be contradicted. Where floors are the same to the last cupboard nothing is ever joined. The floor that
// the robot has just left is out of the question.
class FloorReturn {
 public:
  explicit FloorReturn(const LoopsConfig& config) : config_(config), search_(config) {}

  // The newest keyframe whose floor is known; what joins its floor to an older one, if anything does.
  std::vector<LoopHypothesis> step(KeyframeId keyframe, const PlaceMemory& memory, const WalkedPath& path);

 private:
  struct Evidence {
    int refuted = 0;
    std::vector<LoopHypothesis> agreeing;
  };
  bool recognised(FloorId floor, const WalkedPath& path) const;

  LoopsConfig config_;
  LoopSearch search_;
  int ride_ = 0;    // the newest
  FloorId own_;     // where the newest ride has led to
  FloorId left_;    // where it began
  FloorId latest_;  // of the newest keyframe
  bool joined_ = true;
  std::map<FloorId, Evidence> others_;  // against the floor that the ride has led to
};

}  // namespace sgraphs
