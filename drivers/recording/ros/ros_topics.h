#pragma once

#include <string>

#include "drivers/recording/ros/ros_bag.h"

namespace sgraphs {

// Topics that the user named; empty: left to us.
struct WantedTopics {
  std::string lidar;
  std::string odometry;  // "none": the recording's odometry is not wanted
};

struct ChosenTopics {
  RosTopic lidar;
  RosTopic odometry;  // without a name: there is none
};

// The topic of a readable type where there is one only. Throws UsageError that lists the candidates where the
// user has to choose, or where a named topic is not there or of a type that is not read; Error if there is no
// LiDAR at all.
ChosenTopics chooseTopics(const RosBag& bag, const std::string& path, const WantedTopics& wanted);

}  // namespace sgraphs
