#include "tools/spy/channel_monitor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/channels.h"
#include "common/bus/memory_bus.h"

namespace sgraphs::spy {
namespace {

using testing::HasSubstr;

std::vector<uint8_t> mapToOdom(int64_t seq, int64_t boot = 0) {
  map_to_odom_t message{};
  message.header.session = 1;
  message.header.boot = boot;
  message.header.seq = seq;
  return encoded(message);
}

TEST(ChannelMonitorTest, GapsAreCountedFromWhereTheWatchBegan) {
  ChannelMonitor monitor(Duration{5'000'000});
  for (const int64_t seq : {100, 101, 104, 105}) monitor.step("MAP_TO_ODOM", mapToOdom(seq), Time{1'000'000});
  EXPECT_EQ(monitor.channels().at("MAP_TO_ODOM").lost, 2);
  // A restarted publisher begins at 0.
  for (const int64_t seq : {0, 1}) monitor.step("MAP_TO_ODOM", mapToOdom(seq, 1), Time{1'000'000});
  EXPECT_EQ(monitor.channels().at("MAP_TO_ODOM").lost, 2);
}

TEST(ChannelMonitorTest, OfALogTheBeginningIsAskedFor) {
  ChannelMonitor monitor(std::nullopt);
  monitor.step("MAP_TO_ODOM", mapToOdom(3), Time{});
  EXPECT_EQ(monitor.channels().at("MAP_TO_ODOM").lost, 3);
}

TEST(ChannelMonitorTest, RatesAreOfTheWindow) {
  ChannelMonitor monitor(Duration{2'000'000});
  const auto bytes = mapToOdom(0);
  // 100 Hz for a second, then 10 Hz for four.
  for (int i = 0; i < 100; ++i) monitor.step("MAP_TO_ODOM", bytes, Time{10'000 * i});
  for (int i = 0; i < 40; ++i) monitor.step("MAP_TO_ODOM", bytes, Time{1'000'000 + 100'000 * i});
  const auto rate = monitor.rateOf("MAP_TO_ODOM", Time{5'000'000});
  EXPECT_NEAR(rate.hz, 10.0, 0.51);
  EXPECT_NEAR(rate.bytes_per_s, rate.hz * static_cast<double>(bytes.size()), 1e-6);
  // Silence takes the rate down.
  EXPECT_EQ(monitor.rateOf("MAP_TO_ODOM", Time{60'000'000}).hz, 0.0);
}

TEST(ChannelMonitorTest, RatesOfALogAreOfAllItsTime) {
  ChannelMonitor monitor(std::nullopt);
  for (int i = 0; i < 101; ++i) monitor.step("MAP_TO_ODOM", mapToOdom(i), Time{20'000 * i});
  EXPECT_NEAR(monitor.rateOf("MAP_TO_ODOM", Time{9'000'000}).hz, 50.0, 1e-9);
}

TEST(ChannelMonitorTest, MessagesOfAnotherTypeAndSpoiledOnesAreUndecodable) {
  ChannelMonitor monitor(Duration{5'000'000});
  std::vector<uint8_t> cut = mapToOdom(2);
  cut.pop_back();
  monitor.step("MAP_TO_ODOM", mapToOdom(1), Time{});
  monitor.step("MAP_TO_ODOM", cut, Time{});
  monitor.step("MAP_TO_ODOM", encoded(session_t{}), Time{});
  monitor.step("MAP_TO_ODOM", {}, Time{});
  EXPECT_EQ(monitor.channels().at("MAP_TO_ODOM").undecodable, 3);
  EXPECT_EQ(monitor.channels().at("MAP_TO_ODOM").count, 4);
}

TEST(ChannelMonitorTest, ChannelsOfOthersAreShownForWhatTheyAre) {
  ChannelMonitor monitor(Duration{5'000'000});
  const std::vector<uint8_t> foreign(100, 7);
  monitor.step("CAMERA", foreign, Time{});
  monitor.step("ROBOT_POSE", encoded(pose_t{}), Time{});
  EXPECT_EQ(monitor.channels().at("CAMERA").type, "");
  EXPECT_EQ(monitor.channels().at("ROBOT_POSE").type, "pose_t");
  const std::string table = monitor.table(Time{1'000'000});
  EXPECT_THAT(table, HasSubstr("CAMERA                       (not ours)"));
}

TEST(ChannelMonitorTest, WatchesABusAndShowsOneLinePerChannel) {
  MemoryBus bus;
  ChannelMonitor monitor(Duration{5'000'000});
  for (const channels::Row& row : channels::table()) {
    const std::string name = row.name;
    bus.subscribe(name, [&monitor, name](Bus::Bytes bytes) { monitor.step(name, bytes, Time{}); });
  }
  publish(bus, channels::kPose, pose_t{});
  publish(bus, channels::kRooms, rooms_t{});
  publish(bus, channels::kKeyframePlanes, keyframe_planes_t{});
  bus.dispatch(0);
  EXPECT_EQ(monitor.channels().size(), 3u);
  for (const auto& [name, state] : monitor.channels()) EXPECT_EQ(state.undecodable, 0) << name;
  const std::string table = monitor.table(Time{});
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4);
  // pose_t has no sequence number.
  EXPECT_FALSE(monitor.channels().at("POSE").numbered);
}

}  // namespace
}  // namespace sgraphs::spy
