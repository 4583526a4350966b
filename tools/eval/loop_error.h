#pragma once

#include <vector>

#include "tools/eval/calibration.h"

namespace sgraphs {

// Loop closures of a graph against the truth.
struct LoopResult {
  size_t accepted = 0;  // links of kind loop within the truth's time
  size_t wrong = 0;     // of these: off by more than kFalse_m or kFalse_rad
  double median_m = 0;  // error of the others
  double max_m = 0;
  size_t revisits = 0;  // times that the path came back to where it was
  size_t missed = 0;    // of these: without a loop

  static constexpr double kFalse_m = 0.3;
  static constexpr double kFalse_rad = 0.0873;
  // A return comes within this distance of a place that was left this much path ago. It lasts as long as the
  // path stays there.
  static constexpr double kRevisit_m = 1.0;
  static constexpr double kLeft_m = 10.0;
};

LoopResult judgeLoops(const std::vector<MeasuredLink>& links, const std::vector<StampedPose>& truth);

}  // namespace sgraphs
