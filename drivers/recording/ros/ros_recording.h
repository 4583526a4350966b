#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/recording/packet_source.h"
#include "drivers/recording/ros/ros_topics.h"
#include "drivers/recording/sweep_source.h"

namespace sgraphs {

// What a bag's odometry topic holds.
struct RosOdometryTopic {
  std::vector<BodyOdometry> samples;  // times strictly ascending
  std::string body_frame;
  std::vector<std::string> warnings;
};

// One bag with the topics to convert.
class RosRecording {
 public:
  // Throws as openRos1Bag, openRos2Bag and chooseTopics do.
  RosRecording(const std::string& path, std::unique_ptr<RosBag> bag, const WantedTopics& wanted);

  const ChosenTopics& topics() const { return topics_; }
  std::vector<std::string> files() const { return bag_->files(); }
  // Empty without a topic of odometry. To be called before the LiDAR is read.
  RosOdometryTopic readOdometry();
  // The LiDAR's topic from its beginning: one of the two, by the topic's type; the other is null. They look
  // into this recording.
  std::unique_ptr<PacketSource> packets();
  std::unique_ptr<SweepSource> sweeps();

 private:
  std::string path_;
  std::unique_ptr<RosBag> bag_;
  ChosenTopics topics_;
};

}  // namespace sgraphs
