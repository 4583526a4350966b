#include "drivers/recording/recording_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "drivers/velodyne/vlp16_decoder.h"
#include "tests/common/test_files.h"
#include "tests/drivers/recording/log_contents.h"
#include "tests/drivers/velodyne/packet_builder.h"

namespace sgraphs {
namespace {

using test::kLogStart_us;

Session someSession() {
  Session session;
  session.id = 77;
  session.start = Time{kLogStart_us};
  session.writer = "test";
  return session;
}

VelodynePacket next(test::TurningSensor& sensor) {
  VelodynePacket packet;
  packet.time = Time{kLogStart_us + sensor.timeUs()};
  packet.bytes = sensor.next();
  return packet;
}

// 2.5 s of packets and of odometry at 50 Hz.
test::LogContents writtenLog() {
  const std::string path = test::freshFolder() / "run.lcmlog";
  LogWriter log(path);
  RecordingWriter writer(log, someSession());
  test::TurningSensor sensor;
  int64_t odometry_us = 0;
  while (sensor.time_us < 2.5e6) {
    for (; odometry_us < sensor.timeUs(); odometry_us += 20'000)
      writer.addOdometry({Time{kLogStart_us + odometry_us}, SE3()});
    writer.addPacket(next(sensor));
  }
  writer.finish();
  log.close();
  return test::readLog(path);
}

TEST(RecordingWriterTest, SessionComesFirstAndEverySecond) {
  const auto log = writtenLog();
  EXPECT_EQ(log.order.front(), "SESSION");
  ASSERT_EQ(log.sessions.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(log.sessions[i].header.utime, kLogStart_us + static_cast<int64_t>(i) * 1'000'000);
    EXPECT_EQ(log.sessions[i].header.session, 77);
  }
}

TEST(RecordingWriterTest, LogTimeNeverDecreases) {
  const auto log = writtenLog();
  EXPECT_TRUE(std::is_sorted(log.stamps.begin(), log.stamps.end()));
  EXPECT_EQ(log.stamps.front(), kLogStart_us);
}

TEST(RecordingWriterTest, EveryPacketIsInExactlyOneMessageInOrder) {
  const auto log = writtenLog();
  test::TurningSensor sensor;
  size_t total = 0;
  for (const velodyne_packets_t& message : log.packets) {
    EXPECT_LE(message.num_packets, 20);
    const auto packets = fromMessage(message);
    ASSERT_TRUE(packets);
    for (const VelodynePacket& packet : *packets) {
      const VelodynePacket truth = next(sensor);
      EXPECT_EQ(packet.time, truth.time);
      EXPECT_EQ(packet.bytes, truth.bytes);
      ++total;
    }
  }
  EXPECT_EQ(total, 1884u);
}

TEST(RecordingWriterTest, MessagesCloseWithThePacketThatHoldsTheCut) {
  const auto log = writtenLog();
  RevolutionCutter cutter;
  int64_t revolution = 0;
  int32_t part = 0;
  for (const velodyne_packets_t& message : log.packets) {
    EXPECT_EQ(message.revolution, revolution);
    EXPECT_EQ(message.part, part);
    const auto packets = *fromMessage(message);
    for (size_t i = 0; i < packets.size(); ++i) {
      const bool cut = cutter.step(packets[i].bytes) >= 0;
      EXPECT_EQ(cut, message.last_part && i + 1 == packets.size());
    }
    revolution += message.last_part;
    part = message.last_part ? 0 : part + 1;
  }
  EXPECT_EQ(revolution, 25);
}

TEST(RecordingWriterTest, AMessageIsStampedWithItsLastFiring) {
  const auto log = writtenLog();
  size_t message = 0;
  for (size_t i = 0; i < log.order.size(); ++i) {
    if (log.order[i] != "VELODYNE_PACKETS") continue;
    const int64_t last_us = log.packets[message++].packet_utime.back() + 1306;
    EXPECT_GE(log.stamps[i], last_us);
    EXPECT_LE(log.stamps[i], last_us + 1330);
  }
}

TEST(RecordingWriterTest, StreamEndNamesTheLastMessageOfEachChannel) {
  const auto log = writtenLog();
  ASSERT_TRUE(log.end);
  EXPECT_EQ(log.order.back(), "STREAM_END");
  EXPECT_EQ(log.end->why_not, "");
  EXPECT_THAT(log.end->channel, testing::ElementsAre("SESSION", "SPOT_ODOMETRY", "VELODYNE_PACKETS"));
  EXPECT_THAT(log.end->last_seq, testing::ElementsAre(2, static_cast<int64_t>(log.odometry.size()) - 1,
                                                      static_cast<int64_t>(log.packets.size()) - 1));
  for (size_t i = 0; i < log.packets.size(); ++i) {
    EXPECT_EQ(log.packets[i].header.seq, static_cast<int64_t>(i));
    EXPECT_EQ(log.packets[i].header.utime, log.packets[i].packet_utime.front());
  }
}

TEST(RecordingWriterTest, ScansAreWrittenInChunks) {
  const std::string path = test::freshFolder() / "run.lcmlog";
  LogWriter log(path);
  RecordingWriter writer(log, someSession());
  LidarScan scan;
  scan.end = scan.begin = Time{kLogStart_us + 50'000};
  scan.points.resize(10'000);
  scan.deskewed = true;
  writer.addScan(scan);
  writer.finish();
  log.close();
  const auto contents = test::readLog(path);
  ASSERT_EQ(contents.points.size(), 4u);
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(contents.points[i].header.seq, static_cast<int64_t>(i));
  const auto back = fromMessages(contents.points);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->points.size(), 10'000u);
}

TEST(RecordingWriterTest, ALongGapIsNotFilledWithSessions) {
  const std::string path = test::freshFolder() / "run.lcmlog";
  LogWriter log(path);
  RecordingWriter writer(log, someSession());
  writer.addOdometry({Time{kLogStart_us}, SE3()});
  writer.addOdometry({Time{kLogStart_us + 86'400'000'000}, SE3()});
  writer.finish();
  log.close();
  const auto contents = test::readLog(path);
  EXPECT_EQ(contents.sessions.size(), 2u);
  EXPECT_TRUE(std::is_sorted(contents.stamps.begin(), contents.stamps.end()));
}

TEST(RecordingWriterTest, ASessionWithoutIdIsABrokenPromise) {
  LogWriter log(test::freshFolder() / "run.lcmlog");
  EXPECT_THROW(RecordingWriter(log, Session{}), std::logic_error);
}

}  // namespace
}  // namespace sgraphs
