#pragma once

#include <string>
#include <vector>

#include "backend/graph_builder.h"
#include "backend/loops/loop_layer_config.h"
#include "backend/loops/odometry_chain.h"
#include "common/types/loops.h"

namespace sgraphs {

// Loops of the graph: which ones are known, and which of these have a part in it. A loop that odometry or the
// rest of the graph contradicts is switched off, and comes back when they agree with it.
class LoopLayer {
 public:
  LoopLayer(const LoopLayerConfig& config, GraphBuilder& builder) : config_(config), builder_(builder) {}

  // The measurement of a new keyframe's pose from one before.
  void advance(const RelativePose& z) { chain_.add(z); }

  enum class Change {
    kNone,
    kSmall,  // the whole graph is to be solved
    kLarge,  // likewise, and the map is far from where it will be
    kUndone  // likewise, and its present shape is the work of a loop that is off now
  };
  // Takes loops in and out of the graph; one line in `refused` for each that cannot be used.
  Change apply(const LoopClosures& loops, std::vector<std::string>& refused);

  // To be called when the whole graph has been solved: switches off the loop it contradicts most (others may
  // have been bent by it), or else on what agrees with it.
  Change judge();

 private:
  std::string faultOf(const LoopClosure& loop) const;
  bool odometryAllows(const RelativePose& z) const;
  double chi2(const RelativePose& z) const;  // at the present states
  bool isLarge(const RelativePose& z) const;
  Change switchOn(LoopId id);

  LoopLayerConfig config_;
  GraphBuilder& builder_;
  OdometryChain chain_;
  LoopId newest_;  // of all that came
};

}  // namespace sgraphs
