#include "drivers/recording/convert_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/base/error.h"
#include "tests/common/test_files.h"
#include "tests/drivers/recording/log_contents.h"
#include "tests/drivers/recording/pcap_builder.h"
#include "tests/drivers/velodyne/packet_builder.h"

namespace sgraphs {
namespace {

namespace fs = std::filesystem;
using test::PcapBuilder;
using testing::HasSubstr;

constexpr int64_t kHour_us = 472'222 * int64_t{3'600'000'000};

// Captures a turning sensor, whose stamps are true time past kHour_us + its own time_us.
class Capture {
 public:
  PcapBuilder pcap;
  test::TurningSensor sensor;
  PcapBuilder::Frame frame;

  void add(int packets) {
    for (int i = 0; i < packets; ++i) {
      frame.time_us = kHour_us + sensor.timeUs() + 1500;
      pcap.addUdp(frame, sensor.next());
    }
  }
  void addPositionPacket() {
    PcapBuilder::Frame position = frame;
    position.port = 8308;
    pcap.addUdp(position, std::vector<uint8_t>(512));
  }
};

struct PcapResult {
  ConvertReport report;
  test::LogContents log;
  fs::path folder;
};

void ignoreProgress(double) {}

ConvertReport convertTo(const fs::path& folder, ConvertOptions options) {
  options.output = folder / "out.lcmlog";
  return convertRecording(options, ignoreProgress);
}

PcapResult convertPcap(const std::vector<uint8_t>& bytes, ConvertOptions options = {}) {
  const fs::path folder = test::freshFolder();
  test::writeBytes(folder / "in.pcap", bytes);
  options.pcap = folder / "in.pcap";
  PcapResult result;
  result.report = convertTo(folder, options);
  result.log = test::readLog(folder / "out.lcmlog");
  result.folder = folder;
  return result;
}

// The one line that the conversion fails with; no output may be left behind.
std::string failureOf(const std::vector<uint8_t>& bytes, ConvertOptions options = {}) {
  const fs::path folder = test::freshFolder();
  test::writeBytes(folder / "in.pcap", bytes);
  options.pcap = folder / "in.pcap";
  std::string message = test::messageOf<Error>([&] { convertTo(folder, options); });
  EXPECT_FALSE(fs::exists(folder / "out.lcmlog"));
  EXPECT_FALSE(fs::exists(folder / "out.lcmlog.part"));
  EXPECT_EQ(message.find('\n'), std::string::npos);
  return message;
}

std::vector<int64_t> packetTimes(const test::LogContents& log) {
  std::vector<int64_t> times;
  for (const auto& m : log.packets) times.insert(times.end(), m.packet_utime.begin(), m.packet_utime.end());
  return times;
}

TEST(ConvertRecordingTest, PacketsKeepTheSensorsTimeOverTheHour) {
  Capture capture;
  capture.sensor.time_us = 3'599.9e6;
  capture.add(200);
  const PcapResult result = convertPcap(capture.pcap.bytes());
  EXPECT_EQ(result.report.packets.accepted, 200);
  EXPECT_EQ(result.report.packets.lost, 0);
  EXPECT_EQ(result.report.revolutions, 1);
  const auto times = packetTimes(result.log);
  ASSERT_EQ(times.size(), 200u);
  for (size_t i = 0; i < times.size(); ++i)
    EXPECT_NEAR(static_cast<double>(times[i] - kHour_us), 3'599.9e6 + 1327.104 * static_cast<double>(i), 1.0);
}

TEST(ConvertRecordingTest, VlanTagsPositionPacketsAndOthersAreNoHindrance) {
  Capture capture;
  capture.addPositionPacket();  // before any data packet
  for (int i = 0; i < 100; ++i) {
    capture.frame.vlan_tags = i % 3;
    capture.add(2);
    if (i % 7 == 0) capture.addPositionPacket();
    PcapBuilder::Frame other = capture.frame;
    other.port = 53;
    capture.pcap.addUdp(other, std::vector<uint8_t>(60));
    capture.pcap.addFrame(capture.frame.time_us, std::vector<uint8_t>(60, 0x08));  // not IPv4
  }
  const PcapResult result = convertPcap(capture.pcap.bytes());
  EXPECT_EQ(result.report.packets.accepted, 200);
  EXPECT_EQ(result.report.packets.position, 16);
  EXPECT_EQ(result.report.packets.other_datagrams, 100);
  EXPECT_TRUE(result.report.warnings.empty());
}

TEST(ConvertRecordingTest, FaultsAreCountedAndLeftOut) {
  Capture capture;
  for (int i = 0; i < 100; ++i) {
    capture.add(1);
    test::PacketBytes bad = test::TurningSensor().next();
    bad[500] = 0;
    if (i % 10 == 0) capture.pcap.addUdp(capture.frame, bad);
    if (i % 20 == 0) capture.pcap.addUdp(capture.frame, std::vector<uint8_t>(1000));
    if (i == 50) capture.sensor.skip(3);
  }
  const PcapResult result = convertPcap(capture.pcap.bytes());
  const auto rejected = [&](PacketFault fault) {
    return result.report.packets.rejected[static_cast<size_t>(fault)];
  };
  EXPECT_EQ(result.report.packets.accepted, 100);
  EXPECT_EQ(rejected(PacketFault::kWrongBlockFlag), 10);
  EXPECT_EQ(rejected(PacketFault::kWrongSize), 5);
  EXPECT_EQ(result.report.packets.lost, 3);
  EXPECT_EQ(result.report.warnings.size(), 4u);  // and no complete revolution
  EXPECT_EQ(packetTimes(result.log).size(), 100u);
}

TEST(ConvertRecordingTest, PacketsInWrongOrderAreLeftOut) {
  Capture capture;
  capture.add(50);
  const auto late = test::TurningSensor().next();
  capture.pcap.addUdp(capture.frame, late);
  capture.add(50);
  const PcapResult result = convertPcap(capture.pcap.bytes());
  EXPECT_EQ(result.report.packets.accepted, 100);
  EXPECT_EQ(result.report.packets.rejected[static_cast<size_t>(PacketFault::kOutOfOrder)], 1);
  const auto times = packetTimes(result.log);
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
}

TEST(ConvertRecordingTest, ASecondSensorIsKeptApart) {
  Capture capture;
  for (int i = 0; i < 100; ++i) {
    capture.add(1);
    PcapBuilder::Frame other = capture.frame;
    other.source = 202;
    capture.pcap.addUdp(other, test::TurningSensor().next());
  }
  const PcapResult result = convertPcap(capture.pcap.bytes());
  EXPECT_EQ(result.report.packets.accepted, 100);
  EXPECT_EQ(result.report.packets.other_sensor, 100);
}

TEST(ConvertRecordingTest, ATruncatedCaptureYieldsWhatIsWhole) {
  Capture capture;
  capture.add(200);
  std::vector<uint8_t> bytes = capture.pcap.bytes();
  for (const size_t cut : {1u, 700u, 1248u + 8u}) {
    const PcapResult result = convertPcap({bytes.begin(), bytes.end() - static_cast<std::ptrdiff_t>(cut)});
    EXPECT_EQ(result.report.packets.accepted, 199);
    ASSERT_EQ(result.report.warnings.size(), 1u);
    EXPECT_THAT(result.report.warnings[0], HasSubstr("truncated"));
    EXPECT_TRUE(result.log.end);
  }
}

TEST(ConvertRecordingTest, WhatCannotBeConvertedFailsInOneLine) {
  EXPECT_THAT(failureOf({}), HasSubstr("is empty"));
  EXPECT_THAT(failureOf(std::vector<uint8_t>(100, 'x')), HasSubstr("no pcap or pcapng file"));
  EXPECT_THAT(failureOf(PcapBuilder().bytes()), HasSubstr("no VLP-16 data packet"));
  EXPECT_THAT(failureOf(PcapBuilder(105).bytes()), HasSubstr("IEEE802_11"));

  PcapBuilder dns;
  PcapBuilder::Frame frame;
  frame.port = 53;
  for (int i = 0; i < 10; ++i) dns.addUdp(frame, std::vector<uint8_t>(60));
  EXPECT_THAT(failureOf(dns.bytes()), HasSubstr("10 frames, 10 UDP"));

  Capture snapped;
  snapped.frame.snap = 96;
  snapped.add(20);
  EXPECT_THAT(failureOf(snapped.pcap.bytes()), HasSubstr("20 captured in part"));

  Capture other_port;
  other_port.frame.port = 2369;
  other_port.add(20);
  EXPECT_THAT(failureOf(other_port.pcap.bytes()), HasSubstr("--port 2369"));
  ConvertOptions options;
  options.data_port = 2369;
  EXPECT_EQ(convertPcap(other_port.pcap.bytes(), options).report.packets.accepted, 20);

  Capture fragments;
  fragments.frame.fragment = 0x2000;
  fragments.add(5);
  EXPECT_THAT(failureOf(fragments.pcap.bytes()), HasSubstr("no VLP-16 data packet"));
}

TEST(ConvertRecordingTest, AThirtyTwoBeamSensorIsNamed) {
  PcapBuilder pcap;
  PcapBuilder::Frame frame;
  for (int i = 0; i < 100; ++i) {
    const auto time_us = std::llround(552.96 * i);
    frame.time_us = kHour_us + time_us;
    pcap.addUdp(frame, test::makePacket(
                           200.0 * i, 16.6, static_cast<uint32_t>(time_us), false,
                           [](int, int, int) { return uint16_t{2500}; }, 0x37, 0x21));
  }
  EXPECT_THAT(failureOf(pcap.bytes()), HasSubstr("32-beam"));
}

std::string tumRows(int64_t begin_us, int count) {
  std::string rows;
  for (int i = 0; i < count; ++i) {
    const int64_t t = begin_us + 20'000 * i;
    rows += std::to_string(t / 1'000'000) + "." + std::to_string(1'000'000 + t % 1'000'000).substr(1) + " " +
            std::to_string(i) + " 0 0 0 0 0 1\n";
  }
  return rows;
}

TEST(ConvertRecordingTest, OdometryIsMergedInOrderOfTime) {
  Capture capture;
  capture.add(800);
  const fs::path odometry = test::freshFolder().string() + ".tum";
  test::writeText(odometry, tumRows(kHour_us - 30'000, 60));
  ConvertOptions options;
  options.odometry_tum = odometry;
  options.T_body_lidar = parseTransform("0.12 0 0.31 0 0 0 1", "--T-body-lidar");
  const PcapResult result = convertPcap(capture.pcap.bytes(), options);
  EXPECT_EQ(result.report.odometry, 60);
  ASSERT_EQ(result.log.odometry.size(), 60u);
  EXPECT_EQ(result.log.odometry[3].header.utime, kHour_us + 30'000);
  EXPECT_EQ(result.log.odometry[3].T_odom_body.xyz[0], 3);
  EXPECT_TRUE(std::is_sorted(result.log.stamps.begin(), result.log.stamps.end()));
  EXPECT_EQ(result.log.sessions.front().has_odometry, 1);
  EXPECT_EQ(result.log.sessions.front().odometry_mode, "");
  EXPECT_EQ(result.log.sessions.front().header.utime, kHour_us - 30'000);
  EXPECT_EQ(result.log.sessions.front().T_body_lidar.xyz[2], 0.31);
  EXPECT_EQ(result.log.order.back(), "STREAM_END");
}

TEST(ConvertRecordingTest, OdometryOfAnotherClockIsRefused) {
  Capture capture;
  capture.add(100);
  const fs::path odometry = test::freshFolder().string() + ".tum";
  ConvertOptions options;
  options.odometry_tum = odometry;
  for (const int64_t begin_us : {int64_t{0}, kHour_us + 86'400'000'000}) {
    test::writeText(odometry, tumRows(begin_us, 10));
    EXPECT_THAT(failureOf(capture.pcap.bytes(), options), HasSubstr("share no time"));
  }
}

TEST(ConvertRecordingTest, TheSameInputGivesTheSameBytesAndAnotherAnotherSession) {
  Capture capture, longer;
  capture.add(100);
  longer.add(101);
  const auto first = convertPcap(capture.pcap.bytes());
  const auto first_bytes = test::readBytes(first.folder / "out.lcmlog");
  const auto second = convertPcap(capture.pcap.bytes());
  EXPECT_EQ(first_bytes, test::readBytes(second.folder / "out.lcmlog"));
  EXPECT_GT(first.report.session, 0);
  EXPECT_NE(convertPcap(longer.pcap.bytes()).report.session, first.report.session);
}

TEST(ConvertRecordingTest, AFailureLeavesAnEarlierOutputAlone) {
  const fs::path folder = test::freshFolder();
  test::writeText(folder / "out.lcmlog", "kept");
  test::writeBytes(folder / "in.pcap", PcapBuilder().bytes());
  ConvertOptions options;
  options.pcap = folder / "in.pcap";
  EXPECT_THROW(convertTo(folder, options), Error);
  EXPECT_EQ(test::readBytes(folder / "out.lcmlog").size(), 4u);
}

TEST(ConvertRecordingTest, ARawStreamStartsWhereItIsTold) {
  const fs::path folder = test::freshFolder();
  test::TurningSensor sensor;
  sensor.time_us = 3'599.95e6;
  std::vector<uint8_t> bytes;
  for (int i = 0; i < 200; ++i) {
    const auto packet = sensor.next();
    bytes.insert(bytes.end(), packet.begin(), packet.end());
  }
  test::writeBytes(folder / "raw.bin", bytes);
  ConvertOptions options;
  options.raw = folder / "raw.bin";
  options.raw_start = Time{1'600'000'000'000'000};
  EXPECT_EQ(convertTo(folder, options).packets.accepted, 200);
  const auto times = packetTimes(test::readLog(folder / "out.lcmlog"));
  EXPECT_EQ(times.front(), 1'600'000'000'000'000);
  EXPECT_NEAR(static_cast<double>(times.back() - times.front()), 199 * 1327.104, 1.0);

  bytes.pop_back();
  test::writeBytes(folder / "raw.bin", bytes);
  EXPECT_THAT(test::messageOf<Error>([&] { convertTo(folder, options); }), HasSubstr("no multiple of 1206"));
  test::writeBytes(folder / "raw.bin", std::vector<uint8_t>(1206 * 3));
  EXPECT_THAT(test::messageOf<Error>([&] { convertTo(folder, options); }), HasSubstr("wrong block flag"));
}

TEST(ParseTransformTest, TakesSevenNumbersAndAUnitQuaternion) {
  const SE3 T = parseTransform(" 1, 2, 3 0 0 0.6 0.8", "--T");
  EXPECT_EQ(T.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_DOUBLE_EQ(T.rotation.z(), 0.6);
  EXPECT_DOUBLE_EQ(T.rotation.w(), 0.8);
  for (const char* bad :
       {"", "1 2 3", "1 2 3 0 0 0 1 9", "1 2 3 0 0 0 2", "1 2 x 0 0 0 1", "nan 0 0 0 0 0 1"})
    EXPECT_THROW(parseTransform(bad, "--T"), UsageError) << bad;
}

}  // namespace
}  // namespace sgraphs
