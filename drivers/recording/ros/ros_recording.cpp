#include "drivers/recording/ros/ros_recording.h"

#include <algorithm>
#include <deque>

#include "common/base/error.h"
#include "drivers/recording/ros/ros_messages.h"
#include "drivers/recording/ros/sweep_from_cloud.h"

namespace sgraphs {
namespace {

// The messages of the topic that is selected; those that are not of its type are left out and counted.
class TopicReader {
 public:
  TopicReader(RosBag& bag, RosTopic topic) : bag_(bag), topic_(std::move(topic)) { bag_.select(topic_.name); }

  // Hands the next message to the function; false at the end.
  template <typename Function>
  bool next(Function function) {
    for (;;) try {
        const std::optional<WireReader> message = bag_.next();
        if (!message) return false;
        ++read_;
        function(*message);
        return true;
      } catch (const WireError& e) {
        if (bad_++ == 0) why_bad_ = e.what();
      }
  }

  double progress() const {
    return topic_.count > 0 ? static_cast<double>(read_ + bad_) / static_cast<double>(topic_.count) : 1.0;
  }
  std::string where(const std::string& path) const { return path + ", " + topic_.name; }
  std::vector<std::string> warnings(const std::string& path) const {
    if (bad_ == 0) return {};
    return {where(path) + ": " + std::to_string(bad_) + " message(s) left out, they are no " + topic_.type +
            " (" + why_bad_ + ")"};
  }
  std::string whyNothing(const std::string& path) const {
    std::string text = "topic " + topic_.name + " of '" + path +
                       "' holds nothing that can be used: " + std::to_string(topic_.count) + " messages";
    return bad_ == 0
               ? text
               : text + ", " + std::to_string(bad_) + " of them no " + topic_.type + " (" + why_bad_ + ")";
  }

 private:
  RosBag& bag_;
  RosTopic topic_;
  int64_t read_ = 0, bad_ = 0;
  std::string why_bad_;
};

class RosPacketSource : public PacketSource {
 public:
  RosPacketSource(const std::string& path, RosBag& bag, const RosTopic& topic)
      : PacketSource(path, StampResolver::Clock::kAuto), reader_(bag, topic) {}

  std::optional<VelodynePacket> next() override {
    for (;;) {
      while (!waiting_.empty()) {
        const VelodynePacket raw = waiting_.front();
        waiting_.pop_front();
        if (auto packet = accept(raw.bytes, raw.time, std::nullopt)) return packet;
      }
      const bool more = reader_.next([&](const WireReader& message) {
        for (const RosVelodynePacket& packet : readVelodyneScan(message)) {
          VelodynePacket& raw = waiting_.emplace_back();
          raw.time = packet.stamp;
          std::copy(packet.bytes.begin(), packet.bytes.end(), raw.bytes.begin());
        }
      });
      if (!more) return std::nullopt;
    }
  }
  double progress() const override { return reader_.progress(); }
  std::vector<std::string> warnings() const override {
    std::vector<std::string> lines = PacketSource::warnings();
    for (const std::string& line : reader_.warnings(path_)) lines.push_back(line);
    return lines;
  }
  std::string whyNothing() const override {
    const auto most = std::max_element(counts_.rejected.begin(), counts_.rejected.end());
    if (*most == 0) return reader_.whyNothing(path_);
    return "'" + path_ + "' holds no VLP-16 data packet: " + std::to_string(*most) + " refused as '" +
           toString(static_cast<PacketFault>(most - counts_.rejected.begin())) + "'";
  }

 private:
  TopicReader reader_;
  std::deque<VelodynePacket> waiting_;  // of one message, time as ROS stamped them
};

class RosSweepSource : public SweepSource {
 public:
  RosSweepSource(std::string path, RosBag& bag, const RosTopic& topic)
      : path_(std::move(path)), reader_(bag, topic) {}

  std::optional<LidarScan> next() override {
    std::optional<LidarScan> scan;
    while (!scan &&
           reader_.next([&](const WireReader& message) { scan = accept(readPointCloud(message)); })) {
    }
    return scan;
  }
  double progress() const override { return reader_.progress(); }
  std::string whyNothing() const override { return reader_.whyNothing(path_); }

  std::vector<std::string> warnings() const override {
    std::vector<std::string> lines = reader_.warnings(path_);
    if (late_ > 0)
      lines.push_back(reader_.where(path_) + ": " + std::to_string(late_) +
                      " sweep(s) left out that end no later than the one before");
    if (empty_ > 0)
      lines.push_back(reader_.where(path_) + ": " + std::to_string(empty_) + " sweep(s) without any return");
    if (accepted_ > 0 && to_sweep_.timeField().empty())
      lines.push_back(reader_.where(path_) +
                      ": no field with firing times: the sweeps count as deskewed to their stamps");
    return lines;
  }

 private:
  std::optional<LidarScan> accept(const RosPointCloud& cloud) {
    LidarScan scan = to_sweep_.step(cloud);
    if (scan.points.empty()) {
      ++empty_;
      return std::nullopt;
    }
    if (accepted_ > 0 && scan.end <= previous_end_) {
      ++late_;
      return std::nullopt;
    }
    previous_end_ = scan.end;
    scan.sequence = accepted_++;
    return scan;
  }

  std::string path_;
  TopicReader reader_;
  SweepFromCloud to_sweep_;
  int64_t accepted_ = 0, late_ = 0, empty_ = 0;
  Time previous_end_;
};

}  // namespace

RosRecording::RosRecording(const std::string& path, std::unique_ptr<RosBag> bag, const WantedTopics& wanted)
    : path_(path), bag_(std::move(bag)), topics_(chooseTopics(*bag_, path, wanted)) {}

RosOdometryTopic RosRecording::readOdometry() {
  RosOdometryTopic result;
  if (topics_.odometry.name.empty()) return result;
  TopicReader reader(*bag_, topics_.odometry);
  int64_t late = 0;
  while (reader.next([&](const WireReader& message) {
    const RosOdometry odometry = sgraphs::readOdometry(message);
    result.body_frame = odometry.body_frame;
    // The header's time must tell samples apart.
    if (result.samples.empty() || odometry.sample.time > result.samples.back().time)
      result.samples.push_back(odometry.sample);
    else
      ++late;
  })) {
  }
  if (result.samples.empty()) throw Error(reader.whyNothing(path_) + "; --odometry-topic none leaves it out");
  result.warnings = reader.warnings(path_);
  if (late > 0)
    result.warnings.push_back(reader.where(path_) + ": " + std::to_string(late) +
                              " sample(s) left out that are no later than the one before");
  return result;
}

std::unique_ptr<PacketSource> RosRecording::packets() {
  if (topics_.lidar.type != kVelodyneScanType) return nullptr;
  return std::make_unique<RosPacketSource>(path_, *bag_, topics_.lidar);
}

std::unique_ptr<SweepSource> RosRecording::sweeps() {
  if (topics_.lidar.type != kPointCloudType) return nullptr;
  return std::make_unique<RosSweepSource>(path_, *bag_, topics_.lidar);
}

}  // namespace sgraphs
