#include "drivers/velodyne_live/velodyne_driver_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "common/base/error.h"
#include "common/bus/channels.h"
#include "common/bus/memory_bus.h"
#include "drivers/recording/convert_recording.h"
#include "drivers/session_source.h"
#include "drivers/velodyne_live/pcap_player.h"
#include "tests/common/test_files.h"
#include "tests/drivers/recording/log_contents.h"
#include "tests/drivers/recording/pcap_builder.h"
#include "tests/drivers/velodyne_live/sensor_stream.h"

namespace sgraphs {
namespace {

using test::SensorStream;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

// What a driver on a bus says.
class Heard {
 public:
  explicit Heard(Bus& bus) {
    const auto fail = [] { ADD_FAILURE() << "undecodable"; };
    subscribe(
        bus, channels::kSession, [this](const session_t& m) { sessions.push_back(m); }, fail);
    subscribe(
        bus, channels::kVelodynePackets, [this](const velodyne_packets_t& m) { packets.push_back(m); }, fail);
    subscribe(
        bus, channels::kStatusVelodyneDriver, [this](const status_t& m) { status.push_back(m); }, fail);
    subscribe(
        bus, channels::kStreamEnd, [this](const stream_end_t& m) { ends.push_back(m); }, fail);
  }
  std::vector<session_t> sessions;
  std::vector<velodyne_packets_t> packets;
  std::vector<status_t> status;
  std::vector<stream_end_t> ends;
};

struct Row {
  int64_t count = -1, lost = -1, rejected = -1;
};
Row rowOf(const status_t& status, const std::string& name) {
  for (size_t i = 0; i < status.channel.size(); ++i)
    if (status.channel[i] == name) return {status.count[i], status.lost[i], status.rejected[i]};
  return {};
}

Session someSession() {
  SessionConfig config;
  config.T_body_lidar = "0.1 0 0.3 0 0 0 1";
  return liveSession(config, "test", "digest", Time{SensorStream::kHour_us});
}

class DriverNodeTest : public ::testing::Test {
 protected:
  VelodyneDriverNode makeNode(std::optional<Session> session) {
    VelodyneDriverConfig config;
    config.stamps = "device";
    return {bus_, LivePackets(config, SensorStream::kDataPort, SensorStream::kPositionPort), config,
            std::move(session)};
  }
  MemoryBus bus_;
  Heard heard_{bus_};
};

// A capture of 3 s with a lost packet, a second sensor, position packets and garbage in it.
std::filesystem::path writeCapture() {
  SensorStream stream;
  test::PcapBuilder pcap;
  for (int i = 0; i < 2200; ++i) {
    if (i == 700) stream.sensor.skip(1);
    const UdpDatagram datagram = stream.next();
    test::PcapBuilder::Frame frame;
    frame.time_us = datagram.captured.us;
    pcap.addUdp(frame, datagram.payload);
    if (i % 14 == 0) {
      frame.port = 8308;
      pcap.addUdp(frame, std::vector<uint8_t>(512));
    }
    if (i % 100 == 50) {
      frame.port = 2368;
      pcap.addUdp(frame, std::vector<uint8_t>(1206));
      frame.source = 77;
      pcap.addUdp(frame, datagram.payload);
    }
  }
  auto path = test::freshFolder() / "in.pcap";
  test::writeBytes(path, pcap.bytes());
  return path;
}

TEST_F(DriverNodeTest, PlayingACaptureMakesTheMessagesOfConvert) {
  const auto path = writeCapture();
  ConvertOptions options;
  options.pcap = path;
  options.output = path.parent_path() / "out.lcmlog";
  const ConvertReport report = convertRecording(options, [](double) {});
  const test::LogContents log = test::readLog(options.output);

  VelodyneDriverNode node = makeNode(someSession());
  PcapPlayer player(path, 0, std::nullopt);
  while (!player.ended())
    for (const UdpDatagram& datagram : player.take(100)) node.take(datagram);
  node.finish(true, "");
  bus_.dispatch(0);

  EXPECT_EQ(node.packets().counts().accepted, report.packets.accepted);
  EXPECT_EQ(node.packets().counts().lost, report.packets.lost);
  EXPECT_EQ(node.packets().counts().rejected, report.packets.rejected);
  EXPECT_EQ(node.packets().counts().other_sensor, report.packets.other_sensor);
  ASSERT_EQ(heard_.packets.size(), log.packets.size());
  for (size_t i = 0; i < log.packets.size(); ++i) {
    const velodyne_packets_t &live = heard_.packets[i], &converted = log.packets[i];
    EXPECT_EQ(live.header.seq, converted.header.seq);
    EXPECT_EQ(live.header.utime, converted.header.utime);
    EXPECT_EQ(live.revolution, converted.revolution);
    EXPECT_EQ(live.part, converted.part);
    EXPECT_EQ(live.last_part, converted.last_part);
    EXPECT_EQ(live.packet_utime, converted.packet_utime);
    EXPECT_EQ(live.data, converted.data);
  }
}

TEST_F(DriverNodeTest, SessionComesFirstAndWithEveryCall) {
  VelodyneDriverNode node = makeNode(someSession());
  SensorStream stream;
  for (int i = 0; i < 100; ++i) node.take(stream.next());
  node.everySecond(1.0, Time{SensorStream::kHour_us + 1'000'000}, {});
  node.finish(true, "because");
  node.repeatEnd();
  bus_.dispatch(0);
  ASSERT_EQ(heard_.sessions.size(), 2u);
  EXPECT_EQ(heard_.sessions[0].header.utime, SensorStream::kHour_us);
  EXPECT_EQ(heard_.sessions[1].header.seq, 1);
  EXPECT_EQ(heard_.sessions[0].config_digest, "digest");
  EXPECT_EQ(heard_.sessions[0].odometry_mode, "lidar");
  ASSERT_EQ(heard_.ends.size(), 2u);
  EXPECT_EQ(heard_.ends[0].header.seq, heard_.ends[1].header.seq);
  EXPECT_EQ(heard_.ends[0].why_not, "because");
  EXPECT_THAT(heard_.ends[0].channel, ElementsAre("SESSION", "VELODYNE_PACKETS"));
  EXPECT_THAT(heard_.ends[0].last_seq, ElementsAre(1, static_cast<int64_t>(heard_.packets.size()) - 1));
}

TEST_F(DriverNodeTest, WithoutASessionOfItsOwnItWaitsForOne) {
  VelodyneDriverNode node = makeNode(std::nullopt);
  SensorStream stream;
  for (int i = 0; i < 100; ++i) node.take(stream.next());
  node.everySecond(1.0, Time{SensorStream::kHour_us}, {});
  bus_.dispatch(0);
  EXPECT_TRUE(heard_.packets.empty());
  EXPECT_EQ(heard_.status.back().state, "waiting for SESSION");
  EXPECT_GT(rowOf(heard_.status.back(), "refused: before SESSION").rejected, 50);

  session_t session = toMessage(someSession(), Time{SensorStream::kHour_us});
  session.header.session = 4711;
  session.header.seq = 2;  // it comes late: two repetitions were before it, and are not lost
  publish(bus_, channels::kSession, session);
  session.header.seq = 3;
  publish(bus_, channels::kSession, session);
  bus_.dispatch(0);
  for (int i = 0; i < 100; ++i) node.take(stream.next());
  node.everySecond(1.0, Time{SensorStream::kHour_us}, {});
  node.finish(false, "");
  bus_.dispatch(0);
  ASSERT_FALSE(heard_.packets.empty());
  EXPECT_EQ(heard_.packets.front().header.session, 4711);
  EXPECT_EQ(heard_.packets.front().header.seq, 0);
  EXPECT_EQ(heard_.sessions.size(), 2u);
  const std::vector<int64_t>& lost = heard_.status.back().lost;
  EXPECT_EQ(std::accumulate(lost.begin(), lost.end(), int64_t{0}), 0);
  EXPECT_TRUE(heard_.ends.empty());
}

TEST_F(DriverNodeTest, StatusTellsRateLossAndSilence) {
  VelodyneDriverNode node = makeNode(someSession());
  SensorStream stream;
  for (int i = 0; i < 754; ++i) {
    if (i == 300) stream.sensor.skip(2);
    node.take(stream.next());
  }
  node.take(stream.datagram(std::vector<uint8_t>(7)));
  std::vector<uint8_t> position(512);
  position[202] = 2;
  node.take(stream.datagram(position, SensorStream::kPositionPort));
  node.everySecond(1.0, Time{SensorStream::kHour_us},
                   {.dropped_by_kernel = 2, .dropped_by_queue = 0, .waiting = 5});
  bus_.dispatch(0);
  const status_t& running = heard_.status.back();
  EXPECT_EQ(running.state, "running: 754.0 packets/s, stamps device, GPS pulse locked, no fix");
  EXPECT_EQ(running.queue_depth, 5);
  EXPECT_GT(running.resident_bytes, 0);
  EXPECT_EQ(rowOf(running, "udp data").count, 754);
  EXPECT_EQ(rowOf(running, "udp data").lost, 2);
  EXPECT_EQ(rowOf(running, "udp data").rejected, 1);
  EXPECT_EQ(rowOf(running, "udp position").count, 1);
  EXPECT_EQ(rowOf(running, "refused: not 1206 bytes").rejected, 1);
  EXPECT_EQ(rowOf(running, "dropped by the kernel").lost, 2);
  EXPECT_THAT(node.takeNotices(), Contains(HasSubstr("2 packet(s) dropped by this machine")));

  node.everySecond(1.0, Time{SensorStream::kHour_us},
                   {.dropped_by_kernel = 2, .dropped_by_queue = 0, .waiting = 0});
  node.everySecond(1.0, Time{SensorStream::kHour_us},
                   {.dropped_by_kernel = 2, .dropped_by_queue = 0, .waiting = 0});
  bus_.dispatch(0);
  EXPECT_EQ(heard_.status.back().state, "silent: no LiDAR for 2.0 s");
  const auto notices = node.takeNotices();
  EXPECT_THAT(notices, ElementsAre(HasSubstr("no LiDAR packet for 1.0 s on UDP port 2368")));
  node.take(stream.next());
  node.everySecond(1.0, Time{SensorStream::kHour_us}, {});
  EXPECT_THAT(node.takeNotices(), Contains("LiDAR packets arrive"));
  EXPECT_FALSE(node.silent());
}

TEST(SessionSourceTest, TheConfigurationBecomesASession) {
  SessionConfig config;
  config.T_body_lidar = "0.1 0.2 0.3 0 0 0 1";
  config.odometry = "fused";
  config.stages = "odometry planes";
  const Session session = liveSession(config, "w", "d", Time{123});
  EXPECT_EQ(session.id, 123);
  EXPECT_TRUE(session.has_odometry);
  EXPECT_THAT(session.stages, ElementsAre("odometry", "planes"));
  EXPECT_TRUE(session.T_body_lidar.translation.isApprox(Eigen::Vector3d(0.1, 0.2, 0.3)));
  EXPECT_FALSE(liveSession(SessionConfig{}, "w", "d", Time{123}).has_odometry);
  config.T_body_lidar = "0 0 0";
  EXPECT_THAT(test::messageOf<UsageError>([&] { liveSession(config, "w", "d", Time{123}); }),
              HasSubstr("drivers.session.T_body_lidar '0 0 0'"));
}

TEST(PcapPlayerTest, MovesTheClockAndKeepsTheIntervals) {
  const auto path = writeCapture();
  PcapPlayer kept(path, 0, std::nullopt), moved(path, 0, Time{1'000'000});
  std::vector<UdpDatagram> a, b;
  while (!kept.ended())
    for (auto& d : kept.take(0)) a.push_back(std::move(d));
  while (!moved.ended())
    for (auto& d : moved.take(0)) b.push_back(std::move(d));
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(b.front().captured, Time{1'000'000});
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].captured - a.front().captured, b[i].captured - b.front().captured);
    EXPECT_EQ(a[i].payload, b[i].payload);
  }
}

TEST(PcapPlayerTest, PlaysNoFasterThanAskedFor) {
  const auto path = writeCapture();
  const Stopwatch watch;  // before the player's own
  PcapPlayer player(path, 10, std::nullopt);
  Time newest;
  size_t count = 0;
  const Time begin = player.now();
  while (!player.ended() && count < 700)
    for (const UdpDatagram& d : player.take(100)) {
      newest = d.captured;
      ++count;
      EXPECT_LE((newest - begin).seconds() / 10, watch.elapsedSeconds());
    }
}

}  // namespace
}  // namespace sgraphs
