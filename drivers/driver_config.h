#pragma once

#include "common/config/config_io.h"
#include "drivers/session_config.h"
#include "drivers/spot/spot_bridge_config.h"
#include "drivers/velodyne_live/velodyne_driver_config.h"

namespace sgraphs {

// Settings of the programs that bring the outside world onto the bus. They change what is recorded, never
// what a recording leads to, so they do not belong to the configuration's digest.
struct DriverConfig {
  SessionConfig session;
  VelodyneDriverConfig velodyne_driver;
  SpotBridgeConfig spot_bridge;

  void visit(ConfigVisitor& v) {
    v.section("session", session, "What SESSION says on a robot");
    v.section("velodyne_driver", velodyne_driver, "The VLP-16 on its UDP ports");
    v.section("spot_bridge", spot_bridge, "Odometry of a Spot, over its network interface");
  }
};

}  // namespace sgraphs
