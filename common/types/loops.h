#pragma once

#include <cstdint>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/types/keyframe.h"

namespace sgraphs {

// A verified return to a place: two keyframes' clouds registered to each other.
struct LoopClosure {
  LoopId id;                // stable, never reused
  RelativePose pose;        // of kind kLoop, from the older keyframe
  double overlap = 0;       // share of the newer cloud that the older one's surroundings can show, 0 to 1
  double inlier_share = 0;  // of that share, what lies on the same surfaces, 0 to 1
};

// What a round made of loops.
struct LoopClosures {
  int64_t round = -1;  // whose GRAPH_UPDATE it is made of
  Time time;
  std::vector<LoopClosure> accepted;  // new ones, by id
  std::vector<LoopId> withdrawn;      // accepted before, contradicted by what came later; by id
  bool searching = false;             // work is left that a further round would do
};

}  // namespace sgraphs
