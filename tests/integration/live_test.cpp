#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/bus/channels.h"
#include "tests/tools/system/short_log.h"

// `sgraphs run` with the real processes, lcm-logger and lcm-logplayer.
namespace sgraphs {
namespace {

namespace fs = std::filesystem;

std::string readAll(const fs::path& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string digestIn(const std::string& text) {
  const std::string key = "graph_digest ";
  const size_t at = text.find(key);
  return at == std::string::npos ? "" : text.substr(at + key.size(), 64);
}

int shell(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

struct Live {
  std::string code, said;
  fs::path folder, recording;
};

class LiveTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = fs::path(::testing::TempDir()) / ("live_test_" + std::to_string(getpid()));
    fs::create_directories(folder);
    log = folder / "run.lcmlog";
    testing::writeShortLog(log);
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }

  static Live run(const std::string& treatment, const std::string& process,
                  const std::string& arguments = "") {
    Live live;
    live.folder = folder / (treatment + "_" + process);
    const int hangs =
        shell("sh '" SGRAPHS_SOURCE_DIR "/tests/integration/live_run.sh' '" SGRAPHS_BINARY_DIR "' '" +
              log.string() + "' '" + live.folder.string() + "' " + treatment + " " + process +
              " --set live.deadline_s=0.02 --set odometry.keyframes.distance_m=0.1 " + arguments);
    live.code = readAll(live.folder / "code");
    live.said = readAll(live.folder / "run.txt");
    EXPECT_NE(hangs, 99) << "it hangs:\n" << live.said;
    EXPECT_NE(hangs, 98) << "no multicast on this machine: ip link set lo multicast on; "
                            "ip route add 224.0.0.0/4 dev lo";
    if (fs::exists(live.folder / "recording"))
      for (const auto& entry : fs::directory_iterator(live.folder / "recording"))
        live.recording = entry.path();
    return live;
  }
  // Digest of `sgraphs replay` of the recording, with the same settings.
  static std::string replayed(const Live& live) {
    const fs::path said = live.folder / "replay.txt";
    const int code = shell(SGRAPHS_BINARY_DIR "/sgraphs replay '" + live.recording.string() + "' -o '" +
                           (live.folder / "replay").string() +
                           "' --set odometry.keyframes.distance_m=0.1 >'" + said.string() + "' 2>&1");
    EXPECT_EQ(code, 0) << readAll(said);
    return digestIn(readAll(said));
  }
  // Rounds of a recording that ran without this channel, but the first.
  static int roundsWithout(const fs::path& recording, const std::string& channel) {
    LogReader reader(recording);
    int without = 0;
    while (const auto event = reader.next()) {
      round_schedule_t m{};
      if (event->channel != channels::kRoundSchedule.name || !decode(event->bytes, m) || m.round == 0)
        continue;
      without += std::find(m.channel.begin(), m.channel.end(), channel) == m.channel.end() ? 1 : 0;
    }
    return without;
  }
  static fs::path folder, log;
};
fs::path LiveTest::folder, LiveTest::log;

TEST_F(LiveTest, ALateStageIsLeftOutAndTheRecordingReplaysToTheLiveDigest) {
  for (const auto& [process, channel] :
       {std::pair{"rooms", "ROOMS"}, std::pair{"free-space", "FREE_SPACE"}}) {
    const Live live = run("stutter", process);
    EXPECT_EQ(live.code, "0\n") << live.said;
    ASSERT_EQ(digestIn(live.said).size(), 64u) << live.said;
    EXPECT_GT(roundsWithout(live.recording, channel), 0) << "no deadline passed: the test shows nothing";
    EXPECT_EQ(replayed(live), digestIn(live.said)) << process;
    // The same through the processes in wait mode, which learn of each schedule as late as it was made.
    const fs::path out = live.folder / "played";
    shell("PROCESS_OPTIONS='--set odometry.keyframes.distance_m=0.1' sh '" SGRAPHS_SOURCE_DIR
          "/tests/integration/play_log.sh' '" SGRAPHS_BINARY_DIR "' '" +
          live.recording.string() + "' '" + out.string() + "' 1 >/dev/null 2>&1");
    EXPECT_EQ(readAll(out / "codes"), "0 0 0 0 0 0\n") << readAll(out / "backend.txt");
    EXPECT_EQ(digestIn(readAll(out / "backend.txt")), digestIn(live.said)) << process;
  }
}

// Lines of a file: keyframes, poses.
int linesOf(const fs::path& path) {
  const std::string text = readAll(path);
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

TEST_F(LiveTest, EveryProcessCanBeKilledAndComesBack) {
  const Live whole = run("none", "none", "--rate 0.5");
  const Live live = run("kill", "rooms,planes,free-space,loops,backend,odometry", "--rate 0.5");
  EXPECT_EQ(live.code, "3\n") << live.said;
  EXPECT_NE(live.said.find("6 restart(s) of processes"), std::string::npos) << live.said;
  for (const char* process : {"rooms", "planes", "free-space", "loops", "backend", "odometry"}) {
    const std::string said = readAll(live.folder / "result/log" / (std::string(process) + ".txt"));
    EXPECT_NE(said.find("was killed and is back"), std::string::npos) << process << ":\n" << said;
  }
  const int keyframes = linesOf(whole.folder / "result/keyframes.tum");
  ASSERT_GT(keyframes, 10) << whole.said;
  EXPECT_GE(linesOf(live.folder / "result/keyframes.tum"), keyframes - 3);
  EXPECT_NE(readAll(live.folder / "result/graph.json").find("\"layer\":\"rooms\""), std::string::npos);
  EXPECT_TRUE(fs::is_empty(live.folder / "result/state")) << "an ended session leaves no journal";
}

TEST_F(LiveTest, CtrlCEndsItInOrderWithAResultThatReplays) {
  const Live live = run("interrupt", "none");
  EXPECT_EQ(live.code, "0\n") << live.said;
  ASSERT_EQ(digestIn(live.said).size(), 64u) << live.said;
  EXPECT_TRUE(fs::exists(live.folder / "result/graph.json"));
  EXPECT_EQ(replayed(live), digestIn(live.said));
}

TEST_F(LiveTest, AReplayWithOtherSettingsDoesNotObeyTheSchedule) {
  const Live live = run("none", "none");
  ASSERT_EQ(live.code, "0\n") << live.said;
  const fs::path said = live.folder / "other.txt";
  const int code = shell(SGRAPHS_BINARY_DIR "/sgraphs replay '" + live.recording.string() + "' -o '" +
                         (live.folder / "other").string() + "' >'" + said.string() + "' 2>&1");
  EXPECT_EQ(code, 0) << readAll(said);
  EXPECT_NE(readAll(said).find("ROUND_SCHEDULE is not obeyed"), std::string::npos) << readAll(said);
}

}  // namespace
}  // namespace sgraphs
