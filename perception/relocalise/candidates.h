#pragma once

#include <vector>

#include "perception/loops/loop_verification.h"
#include "perception/relocalise/relocalise_config.h"

namespace sgraphs {

// What one look at one place said.
struct Look {
  KeyframeId anchor;    // of the map
  KeyframeId keyframe;  // of the new session
  double at_m = 0;      // path walked
  SE3 T_map_odom;       // that it leads to
  LoopCheck check;
};

// A pose of the new session's odom in the map that a look has proven and none has refuted.
struct Candidate {
  SE3 T_map_odom;           // by the newest look that saw it
  double seen_m = 0;        // path walked at that look
  std::vector<Look> looks;  // that prove it, in order of the path
  // What its looks' qualities lack against the best ones, over what look-alikes differ by: no look may refute
  // an office that is one door off, but all of them together do.
  double shortfall = 0;
};

// The candidates, and which of them is the robot's pose.
class Candidates {
 public:
  Candidates(const RelocaliseConfig& config, const LoopVerificationConfig& verification)
      : config_(config), verification_(verification) {}

  // By which a candidate's pose may have drifted since it was seen.
  static bool same(const Candidate& candidate, const SE3& T_map_odom, const SE3& T_odom_body, double at_m);

  // All that one look said, best first. `T_odom_body`: where it was taken from. `complete`: no match was left
  // out for want of time, so that a place that looks like the best would be among them.
  void add(const std::vector<Look>& looks, const SE3& T_odom_body, double at_m, bool complete);

  // The candidate that is proven, if the newest look settled it; nullptr: not yet.
  const Candidate* found() const;
  // With the most looks first.
  const std::vector<Candidate>& all() const { return candidates_; }

 private:
  RelocaliseConfig config_;
  LoopVerificationConfig verification_;
  std::vector<Candidate> candidates_;
  bool complete_ = false;  // the newest look
};

}  // namespace sgraphs
