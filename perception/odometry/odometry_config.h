#pragma once

#include "common/config/config_io.h"

namespace sgraphs {

// Members are listed once, in visit(); see config_io.h.
struct OdometryConfig {
  int threads = 2;

  void visit(ConfigVisitor& v) {
    v.field("threads", threads, 1, 64, "Worker threads; the result does not depend on it");
  }
};

}  // namespace sgraphs
