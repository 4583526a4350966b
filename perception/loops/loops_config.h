#pragma once

#include "common/config/config_io.h"

namespace sgraphs {

// Members are listed once, in visit(); see config_io.h.
struct LoopsConfig {
  bool enabled = true;

  void visit(ConfigVisitor& v) { v.field("enabled", enabled, "Loops are looked for"); }
};

}  // namespace sgraphs
