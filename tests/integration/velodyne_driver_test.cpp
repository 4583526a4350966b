#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "tests/drivers/recording/log_contents.h"
#include "tests/tools/system/short_log.h"

// The real driver: a capture played into a log, and packets over UDP sockets recorded by the real lcm-logger.
namespace sgraphs {
namespace {

namespace fs = std::filesystem;
using Packet = std::vector<uint8_t>;

std::string readAll(const fs::path& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

class VelodyneDriverTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = fs::path(::testing::TempDir()) / ("velodyne_driver_test_" + std::to_string(getpid()));
    fs::create_directories(folder);
    log = folder / "run.lcmlog";
    testing::writeShortLog(log);
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }

  static int shell(const std::string& command, std::string& said) {
    const fs::path output = folder / "said.txt";
    const int status = std::system((command + " >'" + output.string() + "' 2>&1").c_str());
    said = readAll(output);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  static std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

  // Sends the log's packets to a driver; what lcm-logger heard of it.
  test::LogContents live(const std::string& name, const std::string& options) {
    const fs::path out = folder / name;
    std::string said;
    const int code =
        shell("sh '" SGRAPHS_SOURCE_DIR "/tests/integration/live_driver.sh' '" SGRAPHS_BINARY_DIR "' " +
                  quoted(log) + " " + quoted(out) + " " + options,
              said);
    driver_said = readAll(out / "driver.txt");
    sender_said = readAll(out / "sender.txt");
    EXPECT_EQ(code, 0) << said << driver_said << sender_said;
    EXPECT_EQ(readAll(out / "code"), "0\n") << driver_said;
    LogReader reader(out / "live.lcmlog");
    while (const auto event = reader.next())
      if (event->channel == "STATUS_VELODYNE_DRIVER") last_status = test::decoded<status_t>(*event);
    return test::readLog(out / "live.lcmlog");
  }
  int64_t rowOf(const std::string& name, const std::vector<int64_t> status_t::*column) const {
    for (size_t i = 0; i < last_status.channel.size(); ++i)
      if (last_status.channel[i] == name) return (last_status.*column)[i];
    return -1;
  }
  int64_t saidBySender(const std::string& pattern) const {
    std::smatch match;
    const std::regex number("(\\d+) " + pattern);
    return std::regex_search(sender_said, match, number) ? std::stoll(match[1]) : -1;
  }

  static std::vector<Packet> packetsOf(const test::LogContents& contents) {
    std::vector<Packet> all;
    for (const velodyne_packets_t& m : contents.packets)
      for (int i = 0; i < m.num_packets; ++i)
        all.emplace_back(m.data.begin() + 1206 * i, m.data.begin() + 1206 * (i + 1));
    return all;
  }
  static void expectWholeLog(const test::LogContents& contents) {
    EXPECT_EQ(contents.order.front(), "SESSION");
    ASSERT_TRUE(contents.end);
    EXPECT_EQ(contents.end->why_not, "");
    ASSERT_EQ(contents.end->last_seq.size(), 2u);
    EXPECT_EQ(contents.end->last_seq[1], static_cast<int64_t>(contents.packets.size()) - 1);
    for (size_t i = 0; i < contents.packets.size(); ++i)
      EXPECT_EQ(contents.packets[i].header.seq, static_cast<int64_t>(i));
  }

  static fs::path folder, log;
  std::string driver_said, sender_said;
  status_t last_status{};
};
fs::path VelodyneDriverTest::folder, VelodyneDriverTest::log;

TEST_F(VelodyneDriverTest, ACapturePlayedIntoALogReplaysLikeAConvertedOne) {
  const fs::path capture = SGRAPHS_SHARED_DATA_DIR "/vlp16/veloview_vlp-16-test-90deg-1-50-frames.pcap";
  if (!fs::exists(capture)) GTEST_SKIP() << "shared data absent: " << capture;
  const fs::path converted = folder / "converted.lcmlog", played = folder / "played.lcmlog";
  std::string said;
  ASSERT_EQ(
      shell(SGRAPHS_BINARY_DIR "/sgraphs convert --pcap " + quoted(capture) + " -o " + quoted(converted),
            said),
      0)
      << said;
  ASSERT_EQ(shell(SGRAPHS_BINARY_DIR "/sgraphs-velodyne-driver --pcap " + quoted(capture) +
                      " --rate 0 --lcm-url 'file://" + played.string() + "?mode=w'",
                  said),
            0)
      << said;
  const test::LogContents a = test::readLog(converted), b = test::readLog(played);
  expectWholeLog(b);
  ASSERT_EQ(a.packets.size(), b.packets.size());
  for (size_t i = 0; i < a.packets.size(); ++i) {
    EXPECT_EQ(a.packets[i].data, b.packets[i].data);
    EXPECT_EQ(a.packets[i].revolution, b.packets[i].revolution);
    EXPECT_EQ(a.packets[i].part, b.packets[i].part);
    EXPECT_EQ(a.packets[i].last_part, b.packets[i].last_part);
  }
  EXPECT_EQ(
      shell(SGRAPHS_BINARY_DIR "/sgraphs replay " + quoted(played) + " -o " + quoted(folder / "out"), said),
      0)
      << said;
}

TEST_F(VelodyneDriverTest, PacketsOverTheNetworkArriveInOrderAndInTheSameGroups) {
  const test::LogContents sent = test::readLog(log), heard = live("clean", "--rate 4");
  expectWholeLog(heard);
  EXPECT_EQ(packetsOf(heard), packetsOf(sent)) << driver_said;
  ASSERT_EQ(heard.packets.size(), sent.packets.size());
  for (size_t i = 0; i < sent.packets.size(); ++i) {
    EXPECT_EQ(heard.packets[i].num_packets, sent.packets[i].num_packets);
    EXPECT_EQ(heard.packets[i].revolution, sent.packets[i].revolution);
    EXPECT_EQ(heard.packets[i].last_part, sent.packets[i].last_part);
  }
  EXPECT_GE(heard.sessions.size(), 2u);
  EXPECT_EQ(last_status.state, "done");
}

TEST_F(VelodyneDriverTest, AFaultyNetworkIsSurvivedAndCounted) {
  const test::LogContents heard =
      live("faulty", "--rate 4 --seed 5 --loss 0.05 --duplicates 0.05 --reorder 0.05 --garbage 0.1");
  expectWholeLog(heard);
  const int64_t sent = saidBySender("data packets"), lost = saidBySender("lost"),
                garbage = saidBySender("datagrams of garbage");
  ASSERT_GT(sent, 0) << sender_said;
  const int64_t accepted = rowOf("udp data", &status_t::count),
                refused = rowOf("udp data", &status_t::rejected);
  EXPECT_EQ(accepted + refused, sent + garbage) << driver_said;
  EXPECT_EQ(rowOf("refused: not 1206 bytes", &status_t::rejected) +
                std::max<int64_t>(0, rowOf("refused: wrong block flag", &status_t::rejected)),
            garbage);
  // An overtaken packet counts as lost when the one after it comes, and is refused when it comes itself.
  EXPECT_GE(rowOf("udp data", &status_t::lost), lost);
  const std::vector<Packet> all = packetsOf(heard), original = packetsOf(test::readLog(log));
  EXPECT_EQ(static_cast<int64_t>(all.size()), accepted);
  // What came through are the sensor's packets in their order.
  auto at = original.begin();
  for (const Packet& packet : all) {
    at = std::find(at, original.end(), packet);
    ASSERT_NE(at, original.end());
    ++at;
  }
}

TEST_F(VelodyneDriverTest, AnswersWrongUsageInOneLine) {
  const std::string program = SGRAPHS_BINARY_DIR "/sgraphs-velodyne-driver";
  std::string said;
  EXPECT_EQ(shell(program + " --help", said), 0);
  EXPECT_EQ(shell(program + " --set drivers.velodyne_driver.stamps=gps", said), 2);
  EXPECT_NE(said.find("must be one of auto, host, device"), std::string::npos) << said;
  EXPECT_EQ(shell(program + " --set drivers.velodyne_driver.source_address=lidar --lcm-url memq://", said),
            2);
  EXPECT_EQ(shell(program + " --pcap " + quoted(log) + " --lcm-url memq://", said), 1);
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  EXPECT_EQ(shell(SGRAPHS_BINARY_DIR "/sgraphs send-packets /nowhere.pcap", said), 1);
  EXPECT_EQ(shell(SGRAPHS_BINARY_DIR "/sgraphs send-packets " + quoted(log) + " --to sensor", said), 2);
}

}  // namespace
}  // namespace sgraphs
