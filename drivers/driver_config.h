#pragma once

#include "common/config/config_io.h"
#include "drivers/spot/spot_bridge_config.h"

namespace sgraphs {

// Settings of the live drivers. They say where data comes from, not what is made of it: no part of the digest
// of a configuration.
struct DriverConfig {
  SpotBridgeConfig spot_bridge;

  void visit(ConfigVisitor& v) {
    v.section("spot_bridge", spot_bridge, "Odometry of a Spot, over its network interface");
  }
};

}  // namespace sgraphs
