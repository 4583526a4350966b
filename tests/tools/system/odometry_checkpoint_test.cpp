#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/memory_bus.h"
#include "tests/tools/system/short_log.h"
#include "tools/system/stages.h"

namespace sgraphs {
namespace {

using Said = std::vector<std::pair<std::string, std::vector<uint8_t>>>;

std::vector<LogEvent> eventsOf(const std::string& mode) {
  const std::string path =
      (std::filesystem::path(::testing::TempDir()) / ("checkpoint_" + mode + std::to_string(getpid())))
          .string();
  testing::writeShortLog(path, mode);
  std::vector<LogEvent> events;
  LogReader reader(path);
  while (std::optional<LogEvent> event = reader.next()) events.push_back(std::move(*event));
  std::filesystem::remove(path);
  return events;
}

// An odometry process' node, with all that it says.
class Listener {
 public:
  Listener() : node_(bus_, makeOdometryParts({})) {
    for (const auto* name : {channels::kOdometry.name, channels::kKeyframe.name, channels::kPoseOdom.name,
                             channels::kOdometryEnd.name})
      bus_.subscribe(name, [this, name](Bus::Bytes bytes) {
        said.emplace_back(name, std::vector<uint8_t>(bytes.begin(), bytes.end()));
      });
  }
  void hear(const LogEvent& event) {
    bus_.publish(event.channel, event.bytes);
    bus_.dispatch(0);
  }
  OdometryNode& node() { return node_; }
  Said said;

 private:
  MemoryBus bus_;
  OdometryNode node_;
};

class OdometryCheckpointTest : public ::testing::TestWithParam<std::string> {};

// Wherever it is killed, what comes after a checkpoint is said to the last byte.
TEST_P(OdometryCheckpointTest, ARestoredProcessSaysWhatItWouldHaveSaid) {
  const std::vector<LogEvent> events = eventsOf(GetParam());
  Listener whole;
  std::map<size_t, std::pair<std::vector<uint8_t>, size_t>> saved;  // by event: state, said so far
  for (size_t i = 0; i < events.size(); ++i) {
    whole.hear(events[i]);
    if (i % 151 != 0 || !whole.node().canSave()) continue;
    StateArchive archive;
    whole.node().visitState(archive);
    saved[i] = {archive.takeBytes(), whole.said.size()};
  }
  ASSERT_TRUE(whole.node().done());
  ASSERT_GT(saved.size(), 3u);
  for (const auto& [i, state] : saved) {
    Listener back;
    StateArchive archive(state.first);
    back.node().visitState(archive);
    EXPECT_TRUE(archive.atEnd());
    for (size_t k = i + 1; k < events.size(); ++k) back.hear(events[k]);
    ASSERT_EQ(back.said.size(), whole.said.size() - state.second) << "after event " << i;
    for (size_t k = 0; k < back.said.size(); ++k)
      ASSERT_EQ(back.said[k], whole.said[state.second + k]) << "message " << k << " after event " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, OdometryCheckpointTest, ::testing::Values("lidar", "encoder", "fused"),
                         [](const auto& mode) { return mode.param; });

TEST(OdometryCheckpointNodeTest, NothingIsSavedBeforeTheSession) {
  Listener fresh;
  EXPECT_FALSE(fresh.node().canSave());
}

}  // namespace
}  // namespace sgraphs
