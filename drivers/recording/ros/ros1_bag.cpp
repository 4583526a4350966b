// The only file that knows rosbag's library.
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <map>

#include "common/base/error.h"
#include "drivers/recording/ros/ros_bag.h"

namespace sgraphs {
namespace {

class Ros1Bag : public RosBag {
 public:
  explicit Ros1Bag(const std::string& path) : path_(path) {
    if (const auto complaint = complaintAbout(path, RecordingKind::kRos1Bag)) throw Error(*complaint);
    guarded([&] {
      bag_.open(path, rosbag::bagmode::Read);
      readTopics();
    });
    if (topics_.empty()) throw Error("bag '" + path + "' holds no message: record it again");
  }

  const std::vector<RosTopic>& topics() const override { return topics_; }
  std::vector<std::string> files() const override { return {path_}; }

  void select(const std::string& topic) override {
    guarded([&] {
      view_ = std::make_unique<rosbag::View>(bag_, rosbag::TopicQuery(topic));
      at_ = view_->begin();
    });
  }

  std::optional<WireReader> next() override {
    std::optional<WireReader> reader;
    guarded([&] {
      if (at_ == view_->end()) return;
      const rosbag::MessageInstance& message = *at_;
      bytes_.resize(message.size());
      ros::serialization::OStream stream(bytes_.data(), static_cast<uint32_t>(bytes_.size()));
      message.write(stream);
      ++at_;
      reader = WireReader::ros1(bytes_);
    });
    return reader;
  }

 private:
  void readTopics() {
    rosbag::View all(bag_);
    std::map<std::string, RosTopic> by_name;
    for (const rosbag::ConnectionInfo* connection : all.getConnections())
      by_name[connection->topic] = {connection->topic, connection->datatype, 0};
    for (auto& [name, topic] : by_name) {
      topic.count = rosbag::View(bag_, rosbag::TopicQuery(name)).size();
      topics_.push_back(topic);
    }
  }

  template <typename Function>
  void guarded(Function function) const {
    try {
      function();
    } catch (const rosbag::BagUnindexedException&) {
      throw Error("bag '" + path_ +
                  "' has no index, its recording was cut off: mend it with `rosbag reindex`");
    } catch (const rosbag::BagException& e) {
      throw Error("'" + path_ + "' is no whole bag of ROS 1 (" + e.what() +
                  "): copy it again, or save what is whole with `rosbag reindex`");
    } catch (const ros::Exception& e) {
      throw Error("bag '" + path_ + "' is damaged (" + e.what() +
                  "): try `rosbag reindex`, or copy it again");
    }
  }

  std::string path_;
  rosbag::Bag bag_;
  std::unique_ptr<rosbag::View> view_;
  rosbag::View::iterator at_;
  std::vector<RosTopic> topics_;
  std::vector<uint8_t> bytes_;
};

}  // namespace

std::unique_ptr<RosBag> openRos1Bag(const std::string& path) {
  return std::make_unique<Ros1Bag>(path);
}

}  // namespace sgraphs
