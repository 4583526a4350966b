#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/tools/system/short_log.h"

// The real programs over LCM, fed by the real lcm-logplayer, against `sgraphs replay` of the same log.
namespace sgraphs {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int code = -1;
  std::string text;  // stdout and stderr
};

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

class ProcessesTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = fs::path(::testing::TempDir()) / ("processes_test_" + std::to_string(getpid()));
    fs::create_directories(folder);
    log = folder / "run.lcmlog";
    testing::writeShortLog(log);
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }

  static Outcome shell(const std::string& command, const fs::path& output) {
    const int status = std::system((command + " >'" + output.string() + "' 2>&1").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readAll(output)};
  }
  static Outcome replay(const fs::path& path, const std::string& name, const std::string& options) {
    return shell(std::string(SGRAPHS_BINARY_DIR "/sgraphs replay '") + path.string() + "' -o '" +
                     (folder / name).string() + "' " + options,
                 folder / (name + ".txt"));
  }
  // Exit codes "<backend> <free-space> <rooms> <loops> <planes> <odometry>" and what they said.
  static std::pair<std::string, std::string> play(const fs::path& path, const std::string& name,
                                                  double speed) {
    const fs::path out = folder / name;
    const Outcome player =
        shell("sh '" SGRAPHS_SOURCE_DIR "/tests/integration/play_log.sh' '" SGRAPHS_BINARY_DIR "' '" +
                  path.string() + "' '" + out.string() + "' " + std::to_string(speed),
              folder / (name + ".txt"));
    std::string said = player.text;
    for (const char* process : {"backend", "free-space", "rooms", "loops", "planes", "odometry"})
      said += readAll(out / (std::string(process) + ".txt"));
    EXPECT_NE(player.code, 99) << "a process hangs:\n" << said;
    EXPECT_NE(player.code, 98) << "no multicast on this machine: ip link set lo multicast on; "
                                  "ip route add 224.0.0.0/4 dev lo\n"
                               << said;
    std::string codes = readAll(out / "codes");
    if (!codes.empty() && codes.back() == '\n') codes.pop_back();
    return {codes, said};
  }

  static fs::path folder, log;
};
fs::path ProcessesTest::folder, ProcessesTest::log;

TEST_F(ProcessesTest, GiveTheDigestOfReplayAtAnySpeed) {
  const Outcome one = replay(log, "replay_1", "--threads 1"), two = replay(log, "replay_2", "--threads 2");
  ASSERT_EQ(one.code, 0) << one.text;
  ASSERT_EQ(two.code, 0) << two.text;
  const std::string expected = digestIn(one.text);
  ASSERT_EQ(expected.size(), 64u) << one.text;
  EXPECT_EQ(digestIn(two.text), expected);
  for (const double speed : {1.0, 4.0}) {
    const auto [codes, said] = play(log, "speed_" + std::to_string(static_cast<int>(speed)), speed);
    EXPECT_EQ(codes, "0 0 0 0 0 0") << said;
    EXPECT_EQ(digestIn(said), expected) << said;
  }
  EXPECT_NE(readAll(folder / "replay_1" / "graph.json").find("\"layer\":\"rooms\""), std::string::npos)
      << "the walk is long enough for the room to be one";
  // The files of the processes are those of replay, byte for byte.
  for (const char* file :
       {"trajectory.tum", "keyframes.tum", "odometry.tum", "graph.json", "graph.g2o", "map.ply"})
    EXPECT_EQ(readAll(folder / "speed_1/result" / file), readAll(folder / "replay_1" / file)) << file;
}

TEST_F(ProcessesTest, ALostMessageEndsWithCodeThreeAndTheReason) {
  for (const std::string channel : {"SPOT_ODOMETRY", "VELODYNE_PACKETS"}) {
    const fs::path path = folder / ("without_" + channel + ".lcmlog");
    testing::copyLog(log, path,
                     [&channel](const LogEvent& e, int i) { return e.channel != channel || i != 40; });
    const std::string reason = "not reproducible: 1 message(s) of " + channel + " lost";
    const auto [codes, said] = play(path, "without_" + channel, 4.0);
    EXPECT_EQ(codes, "3 0 0 0 3 3") << said;
    EXPECT_NE(said.find("sgraphs-backend: " + reason), std::string::npos) << said;
    const Outcome outcome = replay(path, "replay_without_" + channel, "");
    EXPECT_EQ(outcome.code, 3);
    EXPECT_NE(outcome.text.find("sgraphs: " + reason), std::string::npos) << outcome.text;
  }
}

TEST_F(ProcessesTest, AnswerWithTheContractsExitCodes) {
  const std::string program = SGRAPHS_BINARY_DIR "/sgraphs";
  const auto ask = [&](const std::string& arguments) {
    return shell(program + " " + arguments, folder / "said.txt");
  };
  EXPECT_EQ(ask("--version").code, 0);
  EXPECT_EQ(ask("--help").code, 0);
  EXPECT_EQ(ask("replay --help").code, 0);
  EXPECT_EQ(ask("").code, 2);
  EXPECT_EQ(ask("reply").code, 2);
  for (const char* name : {"bench speed", "demo", "view"}) {
    const Outcome answer = ask(std::string(name) + " --any thing");
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.text, std::string("sgraphs: ") + name + ": not in this version\n");
  }
  EXPECT_EQ(ask("replay /nowhere.lcmlog -o " + (folder / "x").string()).code, 1);
  const Outcome unknown_key = ask("replay " + log.string() + " -o x --set backend.max_iteration=3");
  EXPECT_EQ(unknown_key.code, 2);
  EXPECT_NE(unknown_key.text.find("backend.max_iterations"), std::string::npos) << unknown_key.text;
  EXPECT_EQ(ask("replay " + log.string() + " -o x --map /nowhere").code, 1);
  EXPECT_EQ(ask("replay " + log.string() + " -o x --odometry wheels").code, 2);
  EXPECT_EQ(ask("replay " + log.string() + " -o x --layers attic").code, 2);
}

}  // namespace
}  // namespace sgraphs
