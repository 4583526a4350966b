#pragma once

#include <deque>
#include <vector>

#include "perception/loops/loop_search.h"

namespace sgraphs {

// Which verified returns become loops. A return is accepted if no other place that the robot's newest path
// could have been speaks against it, and if it either corrects little or is confirmed by a second one from
// elsewhere; the largest set of loops that are consistent with each other wins over what it contradicts.
class LoopAcceptance {
 public:
  explicit LoopAcceptance(const LoopsConfig& config) : config_(config) {}

  struct Change {
    std::vector<MeasuredLoop> accepted;
    std::vector<LoopHypothesis> evidence;  // of each
    std::vector<MeasuredLoop> withdrawn;
  };
  // What a keyframe's search found.
  Change step(const LoopVerdict& verdict, const WalkedPath& path);
  // The loop cannot be, for reasons that are not seen here.
  void remove(KeyframeId from, KeyframeId to);

 private:
  struct Candidate {
    LoopHypothesis hypothesis;
    bool accepted = false;
    bool likely = false;       // corrects little
    bool map_refuted = false;  // the map's pose cannot be right
  };
  bool contradicted(const Candidate& candidate, const WalkedPath& path) const;
  void forget(double walked_m, const WalkedPath& path);

  LoopsConfig config_;
  std::deque<Candidate> candidates_;  // accepted and waiting, by `to`
  // What keyframes of the newest path could have been, poses known.
  std::deque<MeasuredLoop> possible_;
};

}  // namespace sgraphs
