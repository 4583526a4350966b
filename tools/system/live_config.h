#pragma once

#include "common/config/config_io.h"

namespace sgraphs {

// What a live run decides by the clock.
struct LiveConfig {
  double deadline_s = 0.5;

  void visit(ConfigVisitor& v) {
    v.field("deadline_s", deadline_s, 0.01, 10,
            "How long a round waits for what is made of the round before; later answers join a later round");
  }
};

}  // namespace sgraphs
