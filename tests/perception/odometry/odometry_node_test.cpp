#include "perception/odometry/odometry_node.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/error.h"
#include "tests/tools/system/bus_recorder.h"
#include "tests/tools/system/fake_cores.h"

namespace sgraphs {
namespace {

using testing::FakeOdometry;
using testing::Recorder;
using testing::Source;

class OdometryNodeTest : public ::testing::Test {
 protected:
  void make(const std::string& override_mode = "", size_t points = 20) {
    node = std::make_unique<OdometryNode>(bus, partsOf(std::make_shared<FakeOdometry>(3, points)),
                                          override_mode);
  }
  const stream_end_t& end() const { return ends.messages.at(0); }

  MemoryBus bus;
  Recorder<odometry_t> odometry{bus, channels::kOdometry};
  Recorder<keyframe_t> keyframes{bus, channels::kKeyframe};
  Recorder<pose_t> poses{bus, channels::kPoseOdom};
  Recorder<stream_end_t> ends{bus, channels::kOdometryEnd};
  std::unique_ptr<OdometryNode> node;
  Source source{bus};
};

TEST_F(OdometryNodeTest, PublishesEveryScanAndEndsWithTheLastNumbers) {
  make();
  source.session("lidar", false);
  for (int s = 0; s < 7; ++s) source.packet(0.1 * s);
  EXPECT_EQ(odometry.messages.size(), 7u);
  source.end();
  ASSERT_TRUE(node->done());
  ASSERT_EQ(ends.messages.size(), 1u);
  EXPECT_EQ(end().channel, (std::vector<std::string>{"ODOMETRY", "KEYFRAME"}));
  EXPECT_EQ(end().last_seq, (std::vector<int64_t>{6, 2}));
  EXPECT_EQ(end().why_not, "");
  EXPECT_EQ(poses.messages.size(), 7u);
  EXPECT_EQ(odometry.messages[6].header.session, 7);
  EXPECT_EQ(odometry.messages[6].header.seq, 6);
  EXPECT_EQ(odometry.messages[6].header.utime, Source::at(0.7).us);
}

// A sensor without GPS tells the hour's part only, and a host's clock may be minutes off it: a run lasted
// -150 s.
TEST_F(OdometryNodeTest, TimeIsTheSensorsAlsoWhereSessionIsStampedByAnotherClock) {
  make();
  source.session("lidar", false);
  for (int s = 0; s <= 10; ++s) source.packet(-600 + 0.1 * s);
  source.session("lidar", false);
  EXPECT_EQ(node->now(), Source::at(-599));
  EXPECT_EQ(node->duration(), Duration::fromSeconds(1.0));
  EXPECT_EQ(odometry.messages.size(), 11u);
}

TEST_F(OdometryNodeTest, SendsOdometryBeforeTheChunksOfItsKeyframe) {
  make("", 15000);
  std::vector<std::string> order;
  bus.subscribe("KEYFRAME", [&](Bus::Bytes) { order.push_back("KEYFRAME"); });
  bus.subscribe("ODOMETRY", [&](Bus::Bytes) { order.push_back("ODOMETRY"); });
  source.session("lidar", false);
  source.packet(0);
  EXPECT_EQ(order, (std::vector<std::string>{"ODOMETRY", "KEYFRAME", "KEYFRAME", "KEYFRAME"}));
  EXPECT_TRUE(odometry.messages.at(0).is_keyframe);
}

TEST_F(OdometryNodeTest, InFusedModeAScanWaitsForOdometryUpToItsEnd) {
  make();
  source.session("", true);
  source.odometry(0.0);
  source.packet(0.0);
  source.odometry(0.05);
  EXPECT_EQ(odometry.messages.size(), 0u);
  source.odometry(0.1);
  ASSERT_EQ(odometry.messages.size(), 1u);
  EXPECT_EQ(odometry.messages[0].covariance[0], 1.0 + 3);  // the fake counts its samples
}

TEST_F(OdometryNodeTest, LateOdometryIsDroppedAndCountedButReproducible) {
  make();
  source.session("fused", true);
  for (int s = 0; s <= 10; ++s) source.packet(0.1 * s);
  ASSERT_EQ(odometry.messages.size(), 1u);
  source.odometry(0.05);
  source.odometry(0.09);
  source.end();
  EXPECT_EQ(node->oddities().at("late odometry samples"), 2);
  EXPECT_EQ(node->oddities().at("scans without odometry up to their end"), 11);
  EXPECT_EQ(odometry.messages.size(), 11u);
  EXPECT_EQ(end().why_not, "");
}

TEST_F(OdometryNodeTest, OverrideTakesThePlaceOfTheSessionsMode) {
  make("lidar");
  source.session("encoder", true);
  source.packet(0);
  EXPECT_EQ(odometry.messages.size(), 1u);  // waited for no odometry
}

TEST_F(OdometryNodeTest, AModeThatTheRecordingCannotServeIsAnError) {
  make("encoder");
  EXPECT_THROW(source.session("", false), Error);
  EXPECT_THROW(make("legs"), UsageError);
}

TEST_F(OdometryNodeTest, ALostMessageIsTheReasonAtTheEnd) {
  make();
  source.session("fused", true);
  for (int s = 0; s < 5; ++s) {
    if (s == 2) source.loseNext("SPOT_ODOMETRY");
    source.odometry(0.1 * s);
    source.packet(0.1 * s);
  }
  source.end();
  EXPECT_EQ(end().why_not, "1 message(s) of SPOT_ODOMETRY lost");
  EXPECT_EQ(odometry.messages.size(), 5u);
}

TEST_F(OdometryNodeTest, AMessageLostAtTheEndOfTheStreamIsFound) {
  make();
  source.session("lidar", false);
  source.packet(0);
  source.loseNext("VELODYNE_PACKETS");
  source.packet(0.1);
  source.end();
  EXPECT_EQ(end().why_not, "1 message(s) of VELODYNE_PACKETS lost");
}

TEST_F(OdometryNodeTest, MessagesOfAnotherSessionAreRefusedAndNamed) {
  make();
  source.session("lidar", false);
  Source other(bus, 8);
  other.packet(0);
  EXPECT_EQ(odometry.messages.size(), 0u);
  source.packet(0);
  EXPECT_EQ(odometry.messages.size(), 1u);
  EXPECT_EQ(node->gate().trouble(), "1 message(s) of VELODYNE_PACKETS refused (of another session)");
}

// Regression: everything behind a swapped packet in its message was refused, most of a recording with 5 % of
// them.
TEST_F(OdometryNodeTest, PacketsThatTheNetworkSwappedCostTheirMessageNothing) {
  OdometryParts parts = partsOf(std::make_shared<FakeOdometry>(3, 20));
  std::vector<Time> decoded;
  parts.make_decoder = [&decoded] {
    return [&decoded](const VelodynePacket& packet) {
      decoded.push_back(packet.time);
      return std::optional<LidarScan>();
    };
  };
  OdometryNode with_swapped(bus, parts);
  source.session("lidar", false);
  const auto message = [](const std::vector<double>& times) {
    std::vector<VelodynePacket> packets(times.size());
    for (size_t i = 0; i < times.size(); ++i) packets[i].time = Source::at(times[i]);
    return toMessage(packets, 0, 0, true);
  };
  source.send(channels::kVelodynePackets, message({1.000, 1.003, 1.001, 1.004}));
  EXPECT_EQ(decoded.size(), 4u) << "the decoder judges each for itself";
  EXPECT_EQ(with_swapped.gate().trouble(), "");
  source.send(channels::kVelodynePackets, message({0.5, 1.005}));
  EXPECT_EQ(decoded.size(), 4u);
  EXPECT_EQ(with_swapped.gate().trouble(), "1 message(s) of VELODYNE_PACKETS refused (time runs backwards)");
}

TEST_F(OdometryNodeTest, HostileContentIsRefusedAndDoesNotStopTheStream) {
  make();
  source.session("fused", true);
  spot_odometry_t not_finite = toMessage(BodyOdometry{Source::at(0.01), SE3()});
  not_finite.T_odom_body.xyz[1] = NAN;
  source.send(channels::kSpotOdometry, not_finite);
  source.odometry(1e9);  // decades ahead: would outrun every other sample
  source.odometry(0.05);
  source.odometry(0.04);  // backwards
  velodyne_packets_t short_data{};
  short_data.num_packets = 1;
  short_data.packet_utime = {Source::kStart_us};
  source.send(channels::kVelodynePackets, short_data);
  lidar_points_t bad_chunk{};
  bad_chunk.num_chunks = 1 << 30;
  source.send(channels::kLidarPoints, bad_chunk);
  bus.publish("SPOT_ODOMETRY", std::vector<uint8_t>{1, 2, 3});
  bus.dispatch(0);

  source.packet(0);
  source.odometry(0.2);
  EXPECT_EQ(odometry.messages.size(), 1u);
  EXPECT_EQ(node->gate().counts().at("SPOT_ODOMETRY").rejected, 4);
  EXPECT_EQ(node->gate().counts().at("VELODYNE_PACKETS").rejected, 1);
  EXPECT_EQ(node->gate().counts().at("LIDAR_POINTS").rejected, 1);
}

TEST_F(OdometryNodeTest, AssemblesSweepsAndLeavesOutOneThatLostAChunk) {
  make();
  source.session("lidar", false);
  LidarScan scan;
  scan.points.resize(6000);  // three chunks
  for (int s = 0; s < 3; ++s) {
    scan.sequence = s;
    scan.end = Source::at(0.1 * (s + 1));
    int chunk = 0;
    for (const lidar_points_t& m : toMessages(scan)) {
      if (s == 1 && chunk++ == 1) source.loseNext("LIDAR_POINTS");
      source.send(channels::kLidarPoints, m);
    }
  }
  ASSERT_EQ(odometry.messages.size(), 2u);
  EXPECT_EQ(odometry.messages[1].header.utime, Source::at(0.3).us);
  EXPECT_EQ(node->gate().counts().at("LIDAR_POINTS").lost, 1);
}

TEST_F(OdometryNodeTest, NothingIsWorkedOnBeforeSession) {
  make();
  source.packet(0);
  EXPECT_EQ(odometry.messages.size(), 0u);
  EXPECT_EQ(node->gate().counts().at("VELODYNE_PACKETS").rejected, 1);
}

TEST_F(OdometryNodeTest, FinishEndsAStreamThatHasNoEnd) {
  make();
  source.session("fused", true);
  source.packet(0);
  EXPECT_EQ(odometry.messages.size(), 0u);
  node->finish("stopped");
  bus.dispatch(0);
  EXPECT_EQ(odometry.messages.size(), 1u);
  EXPECT_EQ(end().why_not, "stopped");
  node->repeatEnd();
  bus.dispatch(0);
  ASSERT_EQ(ends.messages.size(), 2u);
  EXPECT_EQ(ends.messages[1].header.seq, ends.messages[0].header.seq);
}

TEST_F(OdometryNodeTest, StatusShowsWhatCameAndWhatWent) {
  make();
  Recorder<status_t> status(bus, channels::kStatusOdometry);
  node->publishStatus();
  source.session("lidar", false);
  source.packet(0);
  node->publishStatus();
  bus.dispatch(0);
  ASSERT_EQ(status.messages.size(), 2u);
  EXPECT_EQ(status.messages[0].state, "waiting for SESSION");
  const status_t& m = status.messages[1];
  EXPECT_EQ(m.state, "running");
  EXPECT_GT(m.resident_bytes, 1 << 20);
  bool found = false;
  for (size_t i = 0; i < m.channel.size(); ++i)
    if (m.channel[i] == "VELODYNE_PACKETS") found = m.count[i] == 1 && m.last_seq[i] == 0;
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace sgraphs
