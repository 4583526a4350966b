#pragma once

#include "common/config/config_io.h"

namespace sgraphs {

// When the robot counts as found in the map of an earlier run. Members are listed once, in visit().
struct RelocaliseConfig {
  double search_spacing_m = 1.0;
  int min_looks = 3;
  int lead = 3;
  double min_span_m = 3.0;
  int max_matches = 24;
  double give_up_m = 300.0;

  void visit(ConfigVisitor& v);
};

}  // namespace sgraphs
