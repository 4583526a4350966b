#pragma once

#include "common/config/config_io.h"

namespace sgraphs {

// Members are listed once, in visit(); see config_io.h.
struct BackendConfig {
  int max_iterations = 10;

  void visit(ConfigVisitor& v) {
    v.field("max_iterations", max_iterations, 1, 100, "Ceres iterations of one round at most");
  }
};

}  // namespace sgraphs
