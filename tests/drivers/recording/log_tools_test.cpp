// log_summary and log_edit, on one log made by the writer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.h"
#include "drivers/recording/log_edit.h"
#include "drivers/recording/log_latency.h"
#include "drivers/recording/log_summary.h"
#include "drivers/recording/recording_writer.h"
#include "tests/common/test_files.h"
#include "tests/drivers/recording/log_contents.h"
#include "tests/drivers/velodyne/packet_builder.h"

namespace sgraphs {
namespace {

namespace fs = std::filesystem;
using test::kLogStart_us;
using testing::HasSubstr;
using testing::Not;

// 4 s of odometry at 50 Hz and packets.
fs::path makeLog() {
  fs::path path = test::freshFolder() / "run.lcmlog";
  LogWriter log(path);
  Session session;
  session.id = 77;
  session.start = Time{kLogStart_us};
  session.writer = "the writer";
  session.has_odometry = true;
  RecordingWriter writer(log, session);
  test::TurningSensor sensor;
  for (int64_t t = 0; t < 4'000'000; t += 20'000) {
    for (; sensor.timeUs() < t;) {
      VelodynePacket packet;
      packet.time = Time{kLogStart_us + sensor.timeUs()};
      packet.bytes = sensor.next();
      writer.addPacket(packet);
    }
    writer.addOdometry({Time{kLogStart_us + t}, SE3()});
  }
  writer.finish();
  log.close();
  return path;
}

// Copies a log without its n-th event of a channel.
void dropEvent(const fs::path& from, const fs::path& to, const std::string& channel, int n) {
  LogReader reader(from);
  LogWriter writer(to);
  int seen = 0;
  while (const auto event = reader.next())
    if (event->channel != channel || seen++ != n)
      writer.write(event->timestamp_us, event->channel, event->bytes);
  writer.close();
}

// Types that were newer than the summary's own list of them ended it.
TEST(LogSummaryTest, EveryChannelOfTheTableIsKnown) {
  const fs::path path = test::freshFolder() / "run.lcmlog";
  LogWriter log(path);
  for (const channels::Row& row : channels::table())
    log.write(kLogStart_us, row.name, std::vector<uint8_t>(50));
  write(log, kLogStart_us, channels::kRooms, rooms_t{});
  write(log, kLogStart_us, channels::kMapChunk, map_chunk_t{});
  log.close();
  const LogSummary summary = summariseLog(path);
  EXPECT_EQ(summary.channels.size(), channels::table().size());
  for (const auto& [name, channel] : summary.channels) EXPECT_EQ(channel.undecodable, 1) << name;
  EXPECT_EQ(summary.channels.at("ROOMS").count, 2);
}

TEST(LogSummaryTest, CountsChannelsAndNamesTheSession) {
  const LogSummary summary = summariseLog(makeLog());
  ASSERT_TRUE(summary.session);
  EXPECT_EQ(summary.session->id, 77);
  EXPECT_TRUE(summary.ended);
  EXPECT_EQ(summary.backward_stamps, 0);
  const ChannelSummary& odometry = summary.channels.at("SPOT_ODOMETRY");
  EXPECT_EQ(odometry.count, 200);
  EXPECT_EQ(odometry.gaps, 0);
  EXPECT_NEAR(odometry.rate_hz(), 50, 0.1);
  EXPECT_EQ(odometry.type, "spot_odometry_t");
  const std::string text = toText(summary, "run.lcmlog");
  EXPECT_THAT(text, HasSubstr("session   77, written by the writer"));
  EXPECT_THAT(text, Not(HasSubstr("warning")));
}

TEST(LogSummaryTest, MissingMessagesAreFoundByTheirNumbers) {
  const fs::path whole = makeLog(), broken = whole.string() + ".broken";
  dropEvent(whole, broken, "SPOT_ODOMETRY", 7);
  EXPECT_EQ(summariseLog(broken).channels.at("SPOT_ODOMETRY").gaps, 1);
  dropEvent(whole, broken, "VELODYNE_PACKETS", 0);
  EXPECT_EQ(summariseLog(broken).channels.at("VELODYNE_PACKETS").gaps, 1);
  dropEvent(whole, broken, "STREAM_END", 0);
  EXPECT_THAT(toText(summariseLog(broken), ""), HasSubstr("no STREAM_END"));
}

TEST(LogSummaryTest, DamageIsTold) {
  const fs::path path = makeLog();
  std::vector<uint8_t> bytes = test::readBytes(path);
  bytes.resize(bytes.size() - 10);
  bytes.insert(bytes.begin() + 28 + 7 +
                   static_cast<std::ptrdiff_t>(summariseLog(path).channels.at("SESSION").bytes / 4),
               5, 0);
  test::writeBytes(path, bytes);
  const LogSummary summary = summariseLog(path);
  EXPECT_TRUE(summary.truncated);
  EXPECT_EQ(summary.skipped_bytes, 5);
  EXPECT_THAT(toText(summary, ""), HasSubstr("truncated"));
}

TEST(LogSummaryTest, MessagesOfAnotherVersionAreCounted) {
  const fs::path path = test::freshFolder() / "old.lcmlog";
  LogWriter log(path);
  log.write(5, "SPOT_ODOMETRY", std::vector<uint8_t>(96));
  log.write(6, "SPOT_ODOMETRY", std::vector<uint8_t>(3));
  log.close();
  const LogSummary summary = summariseLog(path);
  EXPECT_EQ(summary.channels.at("SPOT_ODOMETRY").undecodable, 2);
  EXPECT_THAT(toText(summary, ""), HasSubstr("2 message(s) of SPOT_ODOMETRY are not of type"));
}

TEST(LogSummaryTest, AForeignLogIsListed) {
  const std::string path = std::string(SGRAPHS_SHARED_DATA_DIR) + "/lcm/umich_maebot_convex.lcmlog";
  if (!fs::exists(path)) GTEST_SKIP() << "shared data absent: lcm/umich_maebot_convex.lcmlog";
  const std::string text = toText(summariseLog(path), path);
  EXPECT_THAT(text, HasSubstr("17 time stamps run backwards"));
  EXPECT_THAT(text, HasSubstr("holds no sgraphs channel"));
  EXPECT_THAT(text, HasSubstr("MAEBOT_ENCODERS"));
}

// Packets at 50 Hz recorded 1 ms late; ODOMETRY stamped between the 4th and the 5th, the 8th and the 9th, …
TEST(LogLatencyTest, IsFromTheLastMessageThatWentIn) {
  const fs::path path = test::freshFolder() / "run.lcmlog";
  LogWriter log(path);
  const auto stamped = [](auto message, int64_t stamp_us) {
    message.header.utime = kLogStart_us + stamp_us;
    return message;
  };
  write(log, kLogStart_us - 900, channels::kOdometry,
        stamped(odometry_t{}, -1000));  // of packets not in the log
  for (int64_t i = 0; i < 400; ++i) {
    const int64_t stamp_us = 20'000 * i;
    write(log, kLogStart_us + stamp_us + 1000, channels::kVelodynePackets,
          stamped(velodyne_packets_t{}, stamp_us));
    if (i % 4 != 3) continue;
    const int64_t took_us = 5'000 + 100 * (i / 4);  // 5.0 ms, 5.1 ms … 14.9 ms
    write(log, kLogStart_us + stamp_us + 1000 + took_us, channels::kOdometry,
          stamped(odometry_t{}, stamp_us + 500));
  }
  log.close();
  const LogLatency latency = latencyIn(path, "VELODYNE_PACKETS", "ODOMETRY");
  EXPECT_EQ(latency.count, 100);
  EXPECT_EQ(latency.unpaired, 1);
  EXPECT_EQ(latency.p50_us, 9'900);
  EXPECT_EQ(latency.p90_us, 13'900);
  EXPECT_EQ(latency.p99_us, 14'800);
  EXPECT_EQ(latency.max_us, 14'900);
  EXPECT_EQ(toText(latency, "VELODYNE_PACKETS", "ODOMETRY"),
            "ODOMETRY after VELODYNE_PACKETS: 100 messages (1 more with none before them), p50 9.9 ms, p90 "
            "13.9 ms, "
            "p99 14.8 ms, at most 14.9 ms\n");
  EXPECT_THAT(test::messageOf<UsageError>([&] { latencyIn(path, "LIDAR_POINTS", "ODOMETRY"); }),
              HasSubstr("no message with a header on 'LIDAR_POINTS'"));
  EXPECT_THROW(latencyIn(path, "VELODYNE_PACKETS", "POSE"), UsageError);
}

TEST(LogEditTest, ACutStaysCompleteByItself) {
  const fs::path input = makeLog(), output = input.string() + ".cut";
  LogSelection selection;
  selection.from_s = 1.5;
  selection.to_s = 3.0;
  copyLog(input, output, selection);
  const auto log = test::readLog(output);
  EXPECT_EQ(log.order.front(), "SESSION");
  EXPECT_EQ(log.order.back(), "STREAM_END");
  EXPECT_TRUE(std::is_sorted(log.stamps.begin(), log.stamps.end()));
  ASSERT_FALSE(log.odometry.empty());
  EXPECT_GE(log.odometry.front().header.utime, kLogStart_us + 1'500'000);
  EXPECT_LE(log.odometry.back().header.utime, kLogStart_us + 3'000'000);
  const LogSummary summary = summariseLog(output);
  for (const auto& [name, channel] : summary.channels) EXPECT_EQ(channel.gaps, 0) << name;
  ASSERT_TRUE(log.end);
  for (size_t i = 0; i < log.end->channel.size(); ++i)
    EXPECT_EQ(log.end->last_seq[i], summary.channels.at(log.end->channel[i]).count - 1);
}

TEST(LogEditTest, WhatTheInputLacksStaysLost) {
  const fs::path whole = makeLog(), broken = whole.string() + ".broken", output = whole.string() + ".cut";
  dropEvent(whole, broken, "SPOT_ODOMETRY", 100);
  LogSelection selection;
  selection.from_s = 1.0;
  copyLog(broken, output, selection);
  EXPECT_EQ(summariseLog(output).channels.at("SPOT_ODOMETRY").gaps, 1);
}

TEST(LogEditTest, AFilteredLogPromisesNoOdometry) {
  const fs::path input = makeLog(), output = input.string() + ".filtered";
  LogSelection selection;
  selection.channels = {"VELODYNE_PACKETS"};
  copyLog(input, output, selection);
  const auto log = test::readLog(output);
  EXPECT_TRUE(log.odometry.empty());
  EXPECT_EQ(log.sessions.size(), 4u);
  for (const session_t& session : log.sessions) EXPECT_EQ(session.has_odometry, 0);
  EXPECT_EQ(log.packets.size(), test::readLog(input).packets.size());
  ASSERT_TRUE(log.end);
  EXPECT_THAT(log.end->channel, testing::ElementsAre("SESSION", "VELODYNE_PACKETS"));
}

TEST(LogEditTest, WhatIsNotThereIsNamed) {
  const fs::path input = makeLog(), output = input.string() + ".part";
  LogSelection selection;
  selection.channels = {"VELODYNE_PACKET"};
  EXPECT_THAT(test::messageOf<UsageError>([&] { copyLog(input, output, selection); }),
              HasSubstr("'VELODYNE_PACKET' is not in"));
  EXPECT_FALSE(fs::exists(output));
  LogSelection late;
  late.from_s = 100;
  EXPECT_THAT(test::messageOf<Error>([&] { copyLog(input, output, late); }), HasSubstr("nothing of"));
  EXPECT_FALSE(fs::exists(output));
  EXPECT_THROW(copyLog(input, input, {}), UsageError);
  EXPECT_GT(fs::file_size(input), 1000u);
}

}  // namespace
}  // namespace sgraphs
