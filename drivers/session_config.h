#pragma once

#include <string>

#include "common/config/config_io.h"

namespace sgraphs {

// What SESSION says when a driver, or `sgraphs run`, is its source.
struct SessionConfig {
  std::string T_body_lidar = "0 0 0 0 0 0 1";
  std::string odometry = "lidar";
  std::string stages;

  void visit(ConfigVisitor& v) {
    v.field("T_body_lidar", T_body_lidar, {}, "The LiDAR's mount on the body: x y z [m] qx qy qz qw");
    v.field("odometry", odometry, {"lidar", "encoder", "fused"},
            "Odometry mode; the other two need the legs' odometry on the bus");
    v.field("stages", stages, {}, "Stages that take part, separated by blanks; empty: all");
  }
};

}  // namespace sgraphs
