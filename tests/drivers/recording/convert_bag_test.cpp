// Bags of ROS 1 and ROS 2 become the log that the same data give by other ways.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.h"
#include "drivers/recording/convert_recording.h"
#include "drivers/recording/ros/ros_messages.h"
#include "tests/common/test_files.h"
#include "tests/drivers/recording/log_contents.h"
#include "tests/drivers/recording/pcap_builder.h"
#include "tests/drivers/recording/ros_bag_builder.h"
#include "tests/drivers/recording/ros_builder.h"
#include "tests/drivers/velodyne/packet_builder.h"

namespace sgraphs {
namespace {

namespace fs = std::filesystem;
using test::BagMessage;
using test::Wire;
using testing::AllOf;
using testing::HasSubstr;

constexpr int64_t kBagStart_us = 472'222 * int64_t{3'600'000'000} + 12'000'000;

// A kind of bag.
struct Format {
  const char* name;
  Wire wire;
  test::BagCompression compression = test::BagCompression::kNone;

  bool ros1() const { return wire == Wire::kRos1; }
  ConvertOptions write(const fs::path& folder, const std::vector<BagMessage>& messages) const {
    ConvertOptions options;
    if (ros1())
      test::writeRos1Bag(options.bag = folder / "in.bag", messages, compression);
    else
      test::writeDb3(options.db3 = folder / "in.db3", messages);
    return options;
  }
};

const Format kRos1{"Ros1", Wire::kRos1};
const Format kRos2{"Ros2", Wire::kCdrLittle};

struct BagResult {
  ConvertReport report;
  test::LogContents log;
};

BagResult convert(const fs::path& folder, ConvertOptions options) {
  options.output = folder / "out.lcmlog";
  BagResult result;
  result.report = convertRecording(options, [](double) {});
  result.log = test::readLog(options.output);
  EXPECT_TRUE(std::is_sorted(result.log.stamps.begin(), result.log.stamps.end()));
  EXPECT_EQ(result.log.order.front(), "SESSION");
  EXPECT_EQ(result.log.order.back(), "STREAM_END");
  return result;
}

template <typename Kind = Error>
std::string failureOf(const fs::path& folder, ConvertOptions options) {
  options.output = folder / "out.lcmlog";
  fs::remove(options.output);
  std::string message = test::messageOf<Kind>([&] { convertRecording(options, [](double) {}); });
  EXPECT_FALSE(fs::exists(options.output));
  EXPECT_EQ(message.find('\n'), std::string::npos);
  return message;
}

SE3 poseAt(int i) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.01 * i, Eigen::Vector3d(0.1, 0.2, 1).normalized())),
          {0.02 * i, -0.013 * i, 0.3}};
}

std::vector<BagMessage> odometryMessages(Wire wire, int count) {
  std::vector<BagMessage> messages;
  for (int i = 0; i < count; ++i) {
    const int64_t time_us = kBagStart_us + 20'000 * i;
    // They arrive late and unevenly; their own stamps are what counts.
    messages.push_back({"/odom", kOdometryType, time_us + 5'000 + 900 * (i % 3),
                        test::odometryMessage(wire, time_us, poseAt(i))});
  }
  return messages;
}

// Packets of a turning sensor, 76 to a message as ROS' driver groups them, and the same as a capture.
struct Packets {
  std::vector<BagMessage> messages;
  test::PcapBuilder pcap;

  Packets(Wire wire, int count) {
    test::TurningSensor sensor;
    sensor.time_us = 12e6;
    std::vector<test::StampedPacket> scan;
    for (int i = 0; i < count; ++i) {
      test::PcapBuilder::Frame frame;
      frame.time_us = kBagStart_us - 12'000'000 + sensor.timeUs() + 1500;
      const auto bytes = sensor.next();
      pcap.addUdp(frame, bytes);
      scan.push_back({frame.time_us, {bytes.begin(), bytes.end()}});
      if (scan.size() < 76 && i + 1 < count) continue;
      messages.push_back({"/velodyne_packets", kVelodyneScanType, frame.time_us + 300,
                          test::velodyneScanMessage(wire, scan)});
      scan.clear();
    }
  }
};

std::vector<BagMessage> operator+(std::vector<BagMessage> a, const std::vector<BagMessage>& b) {
  a.insert(a.end(), b.begin(), b.end());
  std::stable_sort(a.begin(), a.end(),
                   [](const auto& x, const auto& y) { return x.received_us < y.received_us; });
  return a;
}

class BagFormatTest : public testing::TestWithParam<Format> {};

TEST_P(BagFormatTest, PacketsAreThoseOfACapture) {
  const fs::path folder = test::freshFolder();
  const Packets packets(GetParam().wire, 400);
  const ConvertOptions options =
      GetParam().write(folder, packets.messages + odometryMessages(GetParam().wire, 30));
  const BagResult bag = convert(folder, options);
  test::writeBytes(folder / "in.pcap", packets.pcap.bytes());
  ConvertOptions capture;
  capture.pcap = folder / "in.pcap";
  const BagResult pcap = convert(folder, capture);

  EXPECT_EQ(bag.report.packets.accepted, 400);
  EXPECT_EQ(bag.report.topics.lidar.name, "/velodyne_packets");
  ASSERT_EQ(bag.log.packets.size(), pcap.log.packets.size());
  for (size_t i = 0; i < bag.log.packets.size(); ++i) {
    velodyne_packets_t a = bag.log.packets[i];
    const velodyne_packets_t& b = pcap.log.packets[i];
    a.header.session = b.header.session;
    std::vector<uint8_t> bytes_a(static_cast<size_t>(a.getEncodedSize())), bytes_b(bytes_a.size());
    a.encode(bytes_a.data(), 0, a.getEncodedSize());
    ASSERT_EQ(b.encode(bytes_b.data(), 0, static_cast<int>(bytes_b.size())), a.getEncodedSize());
    EXPECT_EQ(bytes_a, bytes_b);
  }
}

TEST_P(BagFormatTest, OdometryKeepsItsStampsPosesAndTwists) {
  const fs::path folder = test::freshFolder();
  const Packets packets(GetParam().wire, 400);
  const BagResult result =
      convert(folder, GetParam().write(folder, packets.messages + odometryMessages(GetParam().wire, 30)));
  EXPECT_EQ(result.report.topics.odometry.name, "/odom");
  EXPECT_EQ(result.report.body_frame, "base_link");
  EXPECT_EQ(result.log.sessions.front().has_odometry, 1);
  ASSERT_EQ(result.log.odometry.size(), 30u);
  for (int i = 0; i < 30; ++i) {
    const spot_odometry_t& m = result.log.odometry[static_cast<size_t>(i)];
    EXPECT_EQ(m.header.utime, kBagStart_us + 20'000 * i);
    for (int a = 0; a < 3; ++a) EXPECT_EQ(m.T_odom_body.xyz[a], poseAt(i).translation[a]);
    EXPECT_NEAR(m.T_odom_body.wxyz[0], poseAt(i).rotation.w(), 1e-15);
    EXPECT_NEAR(m.T_odom_body.wxyz[3], poseAt(i).rotation.z(), 1e-15);
  }
  ASSERT_EQ(result.log.poses.size(), 30u);
  for (size_t i = 0; i < 30; ++i) {
    const pose_t& m = result.log.poses[i];
    EXPECT_EQ(m.utime, result.log.odometry[i].header.utime);
    for (int a = 0; a < 3; ++a) EXPECT_EQ(m.pos[a], result.log.odometry[i].T_odom_body.xyz[a]);
    for (int a = 0; a < 3; ++a) EXPECT_EQ(m.vel[a], 0.25 * a);
    for (int a = 0; a < 3; ++a) EXPECT_EQ(m.rotation_rate[a], 0.25 * (3 + a));
  }
}

INSTANTIATE_TEST_SUITE_P(All, BagFormatTest,
                         testing::Values(kRos1, Format{"Ros1Bz2", Wire::kRos1, test::BagCompression::kBz2},
                                         Format{"Ros1Lz4", Wire::kRos1, test::BagCompression::kLz4}, kRos2,
                                         Format{"Ros2BigEndian", Wire::kCdrBig}),
                         [](const auto& test) { return std::string(test.param.name); });

std::vector<BagMessage> scans(Wire wire, int count, const std::string& topic = "/velodyne_points") {
  std::vector<BagMessage> messages;
  for (int i = 0; i < count; ++i) {
    test::CloudBuilder cloud;
    cloud.stamp_us = kBagStart_us + 100'000 * i;
    cloud.width = 5000;
    cloud.fields = {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}, {"time", 12, 7}, {"ring", 16, 4}};
    cloud.point_step = 18;
    cloud.row_step = 18 * cloud.width;
    cloud.data.resize(cloud.row_step);
    for (uint32_t k = 0; k < cloud.width; ++k) {
      cloud.set(18 * k, 1.5f + 0.001f * static_cast<float>(k));
      cloud.set(18 * k + 4, -2.0f);
      cloud.set(18 * k + 8, 0.25f * static_cast<float>(i));
      cloud.set(18 * k + 12, -0.1f + 0.00002f * static_cast<float>(k + 1));
      cloud.set(18 * k + 16, static_cast<uint16_t>(k % 16));
    }
    messages.push_back({topic, kPointCloudType, cloud.stamp_us + 2'000, cloud.message(wire)});
  }
  return messages;
}

class BagCloudTest : public testing::TestWithParam<Format> {};

TEST_P(BagCloudTest, CloudsKeepPointsTimesAndRings) {
  const fs::path folder = test::freshFolder();
  const BagResult result = convert(folder, GetParam().write(folder, scans(GetParam().wire, 3)));
  EXPECT_EQ(result.report.scans, 3);
  EXPECT_TRUE(result.report.warnings.empty());
  ASSERT_EQ(result.log.points.size(), 6u);  // two chunks each
  const auto sweep = fromMessages(std::span(result.log.points).subspan(4, 2));
  ASSERT_TRUE(sweep);
  EXPECT_EQ(sweep->end.us, kBagStart_us + 200'000);
  EXPECT_FALSE(sweep->deskewed);
  EXPECT_EQ(sweep->num_rings, 16);
  ASSERT_EQ(sweep->points.size(), 5000u);
  for (int k = 0; k < 5000; ++k) {
    const LidarPoint& p = sweep->points[static_cast<size_t>(k)];
    EXPECT_EQ(p.position_lidar.x(), 1.5f + 0.001f * static_cast<float>(k));
    EXPECT_EQ(p.position_lidar.z(), 0.5f);
    EXPECT_EQ(p.time_us, 20 * (k + 1) - 100'000);
    EXPECT_EQ(p.ring, k % 16);
  }
}

INSTANTIATE_TEST_SUITE_P(All, BagCloudTest,
                         testing::Values(kRos1, kRos2, Format{"Ros2BigEndian", Wire::kCdrBig}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(ConvertBagTest, TheSameBagGivesTheSameBytes) {
  const fs::path folder = test::freshFolder();
  const ConvertOptions options = kRos2.write(folder, scans(kRos2.wire, 3) + odometryMessages(kRos2.wire, 10));
  convert(folder, options);
  const auto first = test::readBytes(folder / "out.lcmlog");
  convert(folder, options);
  EXPECT_EQ(test::readBytes(folder / "out.lcmlog"), first);
}

TEST(ConvertBagTest, AFolderOfPartsIsOneRecordingInOrderOfTime) {
  const fs::path folder = test::freshFolder();
  fs::create_directories(folder / "walk");
  const auto all = scans(kRos2.wire, 3);
  // By name "_10" comes before "_2".
  test::writeDb3(folder / "walk" / "walk_1.db3", {all[0]});
  test::writeDb3(folder / "walk" / "walk_2.db3", {all[1]});
  test::writeDb3(folder / "walk" / "walk_10.db3", {all[2]});
  ConvertOptions options;
  options.db3 = folder / "walk";
  const BagResult result = convert(folder, options);
  EXPECT_EQ(result.report.scans, 3);
  EXPECT_TRUE(result.report.warnings.empty());
}

TEST(ConvertBagTest, SeveralTopicsAreListedAndOneCanBeChosen) {
  const fs::path folder = test::freshFolder();
  auto second = odometryMessages(kRos1.wire, 10);
  for (BagMessage& message : second) message.topic = "/wheels";
  ConvertOptions options =
      kRos1.write(folder, scans(kRos1.wire, 3, "/front") + scans(kRos1.wire, 2, "/back") +
                              odometryMessages(kRos1.wire, 10) + second);
  EXPECT_THAT(
      failureOf<UsageError>(folder, options),
      AllOf(HasSubstr("--lidar-topic"), HasSubstr("/front (sensor_msgs/PointCloud2)"), HasSubstr("/back")));
  options.topics.lidar = "/back";
  EXPECT_THAT(
      failureOf<UsageError>(folder, options),
      AllOf(HasSubstr("--odometry-topic"), HasSubstr("/odom (nav_msgs/Odometry)"), HasSubstr("/wheels")));
  options.topics.odometry = "/wheels";
  const BagResult result = convert(folder, options);
  EXPECT_EQ(result.report.scans, 2);
  EXPECT_EQ(result.report.odometry, 10);
  options.topics.odometry = "none";
  EXPECT_EQ(convert(folder, options).report.odometry, 0);
  options.topics.lidar = "/side";
  EXPECT_THAT(failureOf<UsageError>(folder, options),
              AllOf(HasSubstr("/side is not in"), HasSubstr("/front")));
  options.topics.lidar = "/odom";
  EXPECT_THAT(failureOf<UsageError>(folder, options), HasSubstr("its type nav_msgs/Odometry is not read"));
}

TEST(ConvertBagTest, ARowFileTakesThePlaceOfTheBagsOdometry) {
  const fs::path folder = test::freshFolder();
  ConvertOptions options = kRos1.write(folder, scans(kRos1.wire, 3) + odometryMessages(kRos1.wire, 10));
  test::writeText(folder / "odom.tum", "1700000412.0 1 2 3 0 0 0 1\n1700000412.1 1 2 3 0 0 0 1\n");
  options.odometry_tum = folder / "odom.tum";
  EXPECT_THAT(failureOf(folder, options), HasSubstr("share no time"));
  const std::string at = std::to_string(kBagStart_us / 1'000'000);
  test::writeText(folder / "odom.tum", at + ".0 1 2 3 0 0 0 1\n" + at + ".1 1 2 3 0 0 0 1\n");
  EXPECT_EQ(convert(folder, options).report.odometry, 2);
}

TEST(ConvertBagTest, MessagesOfAnotherKindAreCounted) {
  const fs::path folder = test::freshFolder();
  auto messages = scans(kRos2.wire, 3) + odometryMessages(kRos2.wire, 10);
  messages[0].bytes.resize(1000);
  ConvertOptions options = kRos2.write(folder, messages);
  const BagResult result = convert(folder, options);
  ASSERT_EQ(result.report.warnings.size(), 1u);
  EXPECT_THAT(result.report.warnings[0], AllOf(HasSubstr("1 message(s) left out"), HasSubstr("/")));

  for (BagMessage& message : messages) message.bytes.resize(20);
  EXPECT_THAT(failureOf(folder, kRos1.write(folder, messages)), HasSubstr("/odom"));
  options = kRos1.write(folder, messages);
  options.topics.odometry = "none";
  EXPECT_THAT(failureOf(folder, options), AllOf(HasSubstr("/velodyne_points"), HasSubstr("3 of them no")));
}

TEST(ConvertBagTest, WhatIsNoBagFailsInOneLineThatSaysWhatToDo) {
  const fs::path folder = test::freshFolder();
  const auto failure = [&](bool ros1, const std::vector<uint8_t>& bytes) {
    test::writeBytes(folder / "in", bytes);
    ConvertOptions options;
    (ros1 ? options.bag : options.db3) = folder / "in";
    return failureOf(folder, options);
  };
  const std::vector<uint8_t> text(3000, 'x');
  const std::vector<uint8_t> mcap{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'},
      zstd{0x28, 0xB5, 0x2F, 0xFD, 0, 0};
  for (const bool ros1 : {true, false}) {
    EXPECT_THAT(failure(ros1, {}), HasSubstr("is empty"));
    EXPECT_THAT(failure(ros1, text), HasSubstr("is no whole bag"));
    EXPECT_THAT(failure(ros1, mcap), AllOf(HasSubstr("MCAP"), HasSubstr("ros2 bag convert")));
    EXPECT_THAT(failure(ros1, zstd), AllOf(HasSubstr("zstd"), HasSubstr("zstd -d")));
  }
  ConvertOptions swapped;
  swapped.db3 = kRos1.write(folder, scans(kRos1.wire, 1)).bag;
  EXPECT_THAT(failureOf(folder, swapped), HasSubstr("give it with --bag"));
  swapped = {};
  swapped.bag = kRos2.write(folder, scans(kRos2.wire, 1)).db3;
  EXPECT_THAT(failureOf(folder, swapped), HasSubstr("give it with --db3"));
  swapped.bag = folder / "absent.bag";
  EXPECT_THAT(failureOf(folder, swapped), HasSubstr("absent.bag"));
  swapped = {};
  swapped.db3 = folder;
  fs::remove(folder / "in.db3");
  EXPECT_THAT(failureOf(folder, swapped), HasSubstr("holds no .db3 file"));
}

TEST(ConvertBagTest, CompressedMessagesOfADb3AreNamed) {
  const fs::path folder = test::freshFolder();
  auto messages = scans(kRos2.wire, 1);
  messages[0].bytes = {0x28, 0xB5, 0x2F, 0xFD, 1, 2, 3};
  EXPECT_THAT(failureOf(folder, kRos2.write(folder, messages)),
              AllOf(HasSubstr("zstd"), HasSubstr("compression_mode")));
}

TEST(ConvertBagTest, ABagWithoutALidarSaysWhatItHolds) {
  const fs::path folder = test::freshFolder();
  for (const Format& format : {kRos1, kRos2})
    EXPECT_THAT(failureOf(folder, format.write(folder, odometryMessages(format.wire, 2))),
                AllOf(HasSubstr("no message of velodyne_msgs/VelodyneScan or sensor_msgs/PointCloud2"),
                      HasSubstr("/odom (nav_msgs/Odometry)")));
}

TEST(ConvertBagTest, ACutBagIsAnErrorAndNeverACrash) {
  const fs::path folder = test::freshFolder();
  for (const Format& format : {kRos1, kRos2}) {
    ConvertOptions options = format.write(folder, scans(format.wire, 3) + odometryMessages(format.wire, 10));
    const std::string path = format.ros1() ? options.bag : options.db3;
    const auto whole = test::readBytes(path);
    for (size_t part = 1; part < 20; ++part) {
      test::writeBytes(
          path, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(whole.size() * part / 20)});
      EXPECT_THAT(failureOf(folder, options), HasSubstr(path));
    }
  }
}

TEST(ConvertBagTest, ABagWithoutItsIndexAsksForReindexing) {
  const fs::path folder = test::freshFolder();
  const ConvertOptions options = kRos1.write(folder, scans(kRos1.wire, 2));
  auto bytes = test::readBytes(options.bag);
  const std::string field = "index_pos=";
  const auto at = std::search(bytes.begin(), bytes.end(), field.begin(), field.end());
  ASSERT_NE(at, bytes.end());
  // As rosbag leaves it until it closes the file.
  std::fill_n(at + static_cast<std::ptrdiff_t>(field.size()), 8, uint8_t{0});
  test::writeBytes(options.bag, bytes);
  EXPECT_THAT(failureOf(folder, options), HasSubstr("rosbag reindex"));
}

}  // namespace
}  // namespace sgraphs
