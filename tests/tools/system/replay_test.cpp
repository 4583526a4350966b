#include "tools/system/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "common/base/error.h"
#include "tests/tools/system/short_log.h"

namespace sgraphs {
namespace {

using ::testing::HasSubstr;

// One log for all cases: made once, changed in copies.
class ReplayTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = std::filesystem::path(::testing::TempDir()) / ("replay_test_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    log = (folder / "run.lcmlog").string();
    testing::writeShortLog(log);
    expected = replay(log).graph_digest;
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder); }

  static RunRecord replay(const std::string& path, int threads = 1, const std::string& odometry = "",
                          std::vector<std::string>* warnings = nullptr,
                          std::vector<std::string> stages = {}) {
    ReplayOptions options;
    options.log = path;
    options.config.odometry.threads = threads;
    options.odometry = odometry;
    options.stages = std::move(stages);
    Replay replay(std::move(options));
    replay.run();
    if (warnings) *warnings = replay.warnings();
    RunRecord record = replay.record();
    record.graph = nullptr;  // ends with the replay
    return record;
  }
  static std::string changed(const std::string& name, const std::function<bool(const LogEvent&, int)>& keep) {
    std::string path = (folder / name).string();
    testing::copyLog(log, path, keep);
    return path;
  }
  static std::string errorOf(const std::string& path) {
    try {
      replay(path);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }

  static std::filesystem::path folder;
  static std::string log, expected;
};
std::filesystem::path ReplayTest::folder;
std::string ReplayTest::log, ReplayTest::expected;

// Its first event once stood at time 0: lcm-logplayer waited 54 years for the second.
TEST_F(ReplayTest, ItsRecordingRunsFromTheBeginningOfTheLog) {
  ReplayOptions options;
  options.log = log;
  options.record = (folder / "all.lcmlog").string();
  const std::string path = options.record;
  Replay replay(std::move(options));
  replay.run();
  LogReader source(log), recorded(path);
  int64_t before = source.next()->timestamp_us, events = 0;
  while (const auto event = recorded.next()) {
    EXPECT_GE(event->timestamp_us, before);
    EXPECT_LE(event->timestamp_us - before, 2'000'000);
    before = event->timestamp_us;
    ++events;
  }
  EXPECT_GT(events, 500);
}

TEST_F(ReplayTest, GivesTheSameDigestAgainAndAtAnyNumberOfThreads) {
  const RunRecord record = replay(log, 2);
  EXPECT_EQ(record.graph_digest, expected);
  EXPECT_EQ(expected.size(), 64u);
  EXPECT_TRUE(record.reproducible) << record.why_not;
  EXPECT_GT(record.scans.size(), 50u);
  EXPECT_EQ(record.stages.at("odometry").count, static_cast<int64_t>(record.scans.size()));
  EXPECT_GT(record.duration_s, 5.0);
  EXPECT_GT(record.realtime_factor, 0.0);
  EXPECT_TRUE(record.gaps.empty());
}

TEST_F(ReplayTest, SegmentsEveryKeyframeUnlessTheStageIsLeftOut) {
  const RunRecord with = replay(log, 2), without = replay(log, 2, "", nullptr, {"odometry", "backend"});
  ASSERT_TRUE(with.stages.contains("planes"));
  EXPECT_GE(with.stages.at("planes").count, 3) << "one per keyframe of a walk of 3 m";
  EXPECT_FALSE(without.stages.contains("planes"));
  EXPECT_TRUE(without.reproducible) << without.why_not;
}

TEST_F(ReplayTest, TheDigestDependsOnTheOdometryMode) {
  const std::string lidar = replay(log, 1, "lidar").graph_digest,
                    encoder = replay(log, 1, "encoder").graph_digest;
  EXPECT_NE(lidar, encoder);
  EXPECT_NE(lidar, expected);
}

TEST_F(ReplayTest, DerivedChannelsOfTheLogAreNotPlayed) {
  const std::string path = (folder / "derived.lcmlog").string();
  LogReader reader(log);
  LogWriter writer(path);
  while (const auto event = reader.next()) {
    writer.write(event->timestamp_us, event->channel, event->bytes);
    writer.write(event->timestamp_us, "ODOMETRY", event->bytes);
    writer.write(event->timestamp_us, "SOMEONE_ELSES", event->bytes);
  }
  writer.close();
  const RunRecord record = replay(path);
  EXPECT_EQ(record.graph_digest, expected);
  EXPECT_TRUE(record.reproducible);
}

TEST_F(ReplayTest, AMissingMessageMakesTheRunNotReproducibleAndSaysWhich) {
  const std::string path = changed(
      "lost.lcmlog", [](const LogEvent& e, int i) { return e.channel != "SPOT_ODOMETRY" || i != 50; });
  const RunRecord record = replay(path);
  EXPECT_FALSE(record.reproducible);
  EXPECT_EQ(record.why_not, "1 message(s) of SPOT_ODOMETRY lost");
  EXPECT_EQ(record.gaps.at("SPOT_ODOMETRY"), 1);
}

TEST_F(ReplayTest, WithoutStreamEndTheLastScanCountsAndTheResultIsTheSame) {
  const std::string path =
      changed("no_end.lcmlog", [](const LogEvent& e, int) { return e.channel != "STREAM_END"; });
  std::vector<std::string> warnings;
  const RunRecord record = replay(path, 1, "", &warnings);
  EXPECT_EQ(record.graph_digest, expected);
  EXPECT_TRUE(record.reproducible);
  EXPECT_THAT(warnings, ::testing::ElementsAre(HasSubstr("no STREAM_END")));
}

TEST_F(ReplayTest, ALogCutWithinAnEventIsPlayedUpToThere) {
  const std::string path = (folder / "cut.lcmlog").string();
  std::filesystem::copy_file(log, path);
  std::filesystem::resize_file(path, std::filesystem::file_size(log) * 2 / 3 + 1);
  std::vector<std::string> warnings;
  const RunRecord record = replay(path, 1, "", &warnings);
  EXPECT_TRUE(record.reproducible);
  EXPECT_GT(record.scans.size(), 30u);
  EXPECT_THAT(warnings, ::testing::Contains(HasSubstr("ends in the middle of an event")));
}

TEST_F(ReplayTest, ALogWithoutSessionIsAnErrorThatSaysWhatToDo) {
  const std::string path =
      changed("no_session.lcmlog", [](const LogEvent& e, int) { return e.channel != "SESSION"; });
  EXPECT_THAT(errorOf(path), HasSubstr("holds no SESSION"));
  EXPECT_THAT(errorOf((folder / "missing.lcmlog").string()), HasSubstr("cannot read log"));
}

TEST_F(ReplayTest, ALogWithoutLidarIsAnError) {
  const std::string path =
      changed("no_lidar.lcmlog", [](const LogEvent& e, int) { return e.channel != "VELODYNE_PACKETS"; });
  EXPECT_THAT(errorOf(path), HasSubstr("gave no keyframe"));
}

TEST_F(ReplayTest, ALogOfAnotherSchemaNamesItsWriter) {
  const std::string path = (folder / "future.lcmlog").string();
  LogWriter writer(path);
  Session session;
  session.id = 1;
  session.writer = "sgraphs 9.0";
  session_t message = toMessage(session, Time{1});
  message.schema = 9;
  write(writer, 1, channels::kSession, message);
  writer.close();
  EXPECT_THAT(errorOf(path), HasSubstr("'sgraphs 9.0' with message schema 9"));
}

TEST_F(ReplayTest, AForeignLogIsAnError) {
  const std::string path = SGRAPHS_SHARED_DATA_DIR "/lcm/umich_maebot_convex.lcmlog";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "shared data absent: " << path;
  EXPECT_THAT(errorOf(path), HasSubstr("holds no SESSION"));
}

TEST(SystemConfigTest, TheShippedFileIsCompleteAndHoldsTheDefaults) {
  SystemConfig defaults;
  std::ifstream in(SGRAPHS_SOURCE_DIR "/config/sgraphs.yaml");
  const std::string shipped((std::istreambuf_iterator<char>(in)), {});
  EXPECT_EQ(shipped, configToYaml(visitOf(defaults)))
      << "sgraphs-odometry --print-config > config/sgraphs.yaml";
}

TEST(SystemConfigTest, TheDigestIsThatOfTheSettingsNotOfTheThreadsOrDrivers) {
  SystemConfig one, two;
  two.odometry.threads = one.odometry.threads + 1;
  EXPECT_EQ(digestOf(one), digestOf(two));
  two.drivers.spot_bridge.host = "192.168.80.3";
  EXPECT_EQ(digestOf(one), digestOf(two));
  two.backend.max_iterations += 1;
  EXPECT_NE(digestOf(one), digestOf(two));
}

}  // namespace
}  // namespace sgraphs
