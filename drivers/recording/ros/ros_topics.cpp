#include "drivers/recording/ros/ros_topics.h"

#include <algorithm>
#include <vector>

#include "common/base/error.h"
#include "drivers/recording/ros/ros_messages.h"

namespace sgraphs {
namespace {

// What a topic is wanted for.
struct Purpose {
  const char* what;
  const char* option;
  std::vector<std::string> types;

  bool suits(const RosTopic& topic) const {
    return std::find(types.begin(), types.end(), topic.type) != types.end();
  }
  std::string typesText() const {
    std::string text;
    for (const std::string& type : types) text += (text.empty() ? "" : " or ") + type;
    return text;
  }
};

std::string list(const std::vector<RosTopic>& topics) {
  std::string text;
  for (const RosTopic& topic : topics)
    text += (text.empty() ? "" : ", ") + topic.name + " (" + topic.type + ")";
  return text;
}

RosTopic named(const RosBag& bag, const std::string& path, const std::string& name, const Purpose& purpose) {
  for (const RosTopic& topic : bag.topics()) {
    if (topic.name != name) continue;
    if (!purpose.suits(topic))
      throw UsageError(std::string(purpose.option) + " " + name + ": its type " + topic.type +
                       " is not read, only " + purpose.typesText());
    return topic;
  }
  throw UsageError(std::string(purpose.option) + " " + name + " is not in '" + path +
                   "', which holds: " + list(bag.topics()));
}

std::vector<RosTopic> candidates(const RosBag& bag, const Purpose& purpose) {
  std::vector<RosTopic> found;
  for (const RosTopic& topic : bag.topics())
    if (purpose.suits(topic) && topic.count > 0) found.push_back(topic);
  return found;
}

[[noreturn]] void askFor(const std::string& path, const std::vector<RosTopic>& found,
                         const Purpose& purpose) {
  throw UsageError("'" + path + "' holds " + std::to_string(found.size()) + " topics with " + purpose.what +
                   ": choose one with " + purpose.option + ": " + list(found));
}

}  // namespace

ChosenTopics chooseTopics(const RosBag& bag, const std::string& path, const WantedTopics& wanted) {
  const Purpose lidar{"a LiDAR", "--lidar-topic", {kVelodyneScanType, kPointCloudType}};
  const Purpose odometry{"odometry", "--odometry-topic", {kOdometryType}};
  ChosenTopics chosen;
  if (!wanted.lidar.empty()) {
    chosen.lidar = named(bag, path, wanted.lidar, lidar);
  } else {
    const std::vector<RosTopic> found = candidates(bag, lidar);
    if (found.empty())
      throw Error("'" + path + "' holds no message of " + lidar.typesText() + ", but: " + list(bag.topics()));
    if (found.size() > 1) askFor(path, found, lidar);
    chosen.lidar = found.front();
  }
  if (wanted.odometry == "none") return chosen;
  if (!wanted.odometry.empty()) {
    chosen.odometry = named(bag, path, wanted.odometry, odometry);
  } else {
    const std::vector<RosTopic> found = candidates(bag, odometry);
    if (found.size() > 1) askFor(path, found, odometry);
    if (!found.empty()) chosen.odometry = found.front();
  }
  return chosen;
}

}  // namespace sgraphs
