// The program sgraphs-spot-bridge itself, writing into a log in place of a bus.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "common/bus/channels.h"
#include "common/bus/log_file.h"
#include "common/io/text_file.h"
#include "lcmtypes/convert/convert.h"
#include "tests/drivers/spot/fake_robot.h"
#include "tests/drivers/spot/fake_trajectory.h"
#include "tests/support/temp_folder.h"

namespace sgraphs {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct Outcome {
  int code = -1;
  std::string text;
};

class SpotBridgeProcessTest : public ::testing::Test {
 protected:
  SpotBridgeProcessTest() {
    writeFile(folder_ / "robot.pem", robot_.rootCertPem());
    writeCredentials("tick-tock-42", 0600);
  }
  void writeCredentials(const std::string& password, mode_t mode) {
    const std::string path = folder_ / "spot.env";
    writeFile(path, "SGRAPHS_SPOT_USER=walker\nSGRAPHS_SPOT_PASSWORD=" + password + "\n");
    chmod(path.c_str(), mode);
  }
  std::string usual() const {
    return "--host 127.0.0.1 --set drivers.spot_bridge.port=" + std::to_string(robot_.port()) +
           " --root-cert '" + (folder_ / "robot.pem") + "' --credentials '" + (folder_ / "spot.env") +
           "' --lcm-url 'file://" + (folder_ / "run.lcmlog") + "?mode=w'";
  }
  // Starts the program behind a shell that becomes it.
  pid_t start(const std::string& arguments) {
    const std::string command = "exec " SGRAPHS_BINARY_DIR "/sgraphs-spot-bridge " + arguments + " >'" +
                                (folder_ / "said.txt") + "' 2>&1";
    const char* const argv[] = {"sh", "-c", command.c_str(), nullptr};
    pid_t pid = -1;
    EXPECT_EQ(posix_spawn(&pid, "/bin/sh", nullptr, nullptr, const_cast<char* const*>(argv), environ), 0);
    return pid;
  }
  Outcome outcomeOf(pid_t pid) {
    int status = 0;
    waitpid(pid, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readFile(folder_ / "said.txt")};
  }
  Outcome run(const std::string& arguments) { return outcomeOf(start(arguments)); }

  test::TempFolder folder_;
  test::FakeRobot robot_{{}};
};

TEST_F(SpotBridgeProcessTest, WritesALogOfItsOwnSessionAndEndsItOnASignal) {
  const pid_t pid = start(usual() + " --session --set 'drivers.session.T_body_lidar=0.1 0 0.3 0 0 0 1'");
  for (int i = 0; i < 300 && robot_.calls().states < 20; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  kill(pid, SIGTERM);
  const Outcome outcome = outcomeOf(pid);
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("sgraphs-spot-bridge: listening\n"));
  EXPECT_THAT(outcome.text, HasSubstr("sgraphs-spot-bridge: synchronised: the robot's clock is ahead by"));
  EXPECT_THAT(outcome.text, Not(HasSubstr("tick-tock-42")));
  std::cout << outcome.text;

  std::vector<std::string> channels;
  stream_end_t end{};
  LogReader log(folder_ / "run.lcmlog");
  while (const auto event = log.next()) {
    channels.push_back(event->channel);
    if (event->channel == channels::kStreamEnd.name) decode(event->bytes, end);
  }
  ASSERT_FALSE(channels.empty());
  EXPECT_EQ(channels.front(), "SESSION");
  EXPECT_THAT(channels, ::testing::Contains("STATUS_SPOT_BRIDGE"));
  const auto samples = test::readOdometryOfLog(folder_ / "run.lcmlog");
  EXPECT_GE(samples.size(), 15u);
  ASSERT_EQ(end.channel, (std::vector<std::string>{"SESSION", "SPOT_ODOMETRY"}));
  EXPECT_EQ(end.last_seq[1], static_cast<int64_t>(samples.size()) - 1);
}

TEST_F(SpotBridgeProcessTest, AWrongPasswordEndsItWithOneLine) {
  writeCredentials("tick-tack-43", 0600);
  const Outcome outcome = run(usual());
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("sgraphs-spot-bridge: the robot refuses user and password: check"));
  EXPECT_THAT(outcome.text, Not(HasSubstr("tick-tack-43")));
  EXPECT_EQ(robot_.calls().refused_logins, 1);
}

TEST_F(SpotBridgeProcessTest, WrongUsageIsNamedInOneLine) {
  const auto expectUsage = [&](const std::string& arguments, const std::string& text) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_THAT(outcome.text, HasSubstr("sgraphs-spot-bridge: " + text)) << arguments;
    EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 1) << outcome.text;
  };
  expectUsage("", "give the robot's name or address: --host");
  expectUsage("--host 127.0.0.1", "give the certificate that signed the robot's: --root-cert FILE");
  expectUsage(usual() + " --frame odo", "--set: 'frame' = 'odo' must be one of odom, vision");
  expectUsage(usual() + " --session --set drivers.session.T_body_lidar=1",
              "drivers.session.T_body_lidar '1': give seven");
  writeCredentials("tick-tock-42", 0644);
  expectUsage(usual(),
              "the credentials file '" + (folder_ / "spot.env") + "' can be read or written by others");
  EXPECT_EQ(run("--help").code, 0);
  EXPECT_EQ(robot_.calls().logins, 0);
}

}  // namespace
}  // namespace sgraphs
