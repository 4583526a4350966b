#pragma once

#include "common/config/config_io.h"

namespace sgraphs {

// Members are listed once, in visit(); see config_io.h.
struct LoopLayerConfig {
  double contradiction_chi2 = 27.9;
  double agreement_chi2 = 12.6;
  double chain_slack = 3.0;
  double large_m = 0.1;
  double large_rad = 0.01;

  void visit(ConfigVisitor& v) {
    v.field("contradiction_chi2", contradiction_chi2, 1.0, 1e6,
            "A loop is switched off beyond this chi-square with 6 degrees of freedom (99.99 %)");
    v.field("agreement_chi2", agreement_chi2, 1.0, 1e6,
            "A loop that was switched off comes back below this (95 %)");
    v.field("chain_slack", chain_slack, 1.0, 100.0,
            "How much larger odometry's errors may be than it says, for a loop to be believed");
    v.field("large_m", large_m, 0.0, 100.0, "A loop that is off by more moves the map before it is solved");
    v.field("large_rad", large_rad, 0.0, 3.2, "Likewise, in direction");
  }
};

}  // namespace sgraphs
