#include "tools/run/supervisor.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace sgraphs {
namespace {

using Role = ProcessRow::Role;

TEST(RestartPolicyTest, WaitsTwiceAsLongEachTimeUpToTenSeconds) {
  RestartPolicy policy;
  std::vector<double> delays;
  delays.reserve(9);
  for (int i = 0; i < 9; ++i) delays.push_back(policy.delayAfter(0.5));
  EXPECT_EQ(delays, (std::vector<double>{0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4, 10, 10}));
}

TEST(RestartPolicyTest, ALongLifeIsAFreshStart) {
  RestartPolicy policy;
  for (int i = 0; i < 9; ++i) policy.delayAfter(1);
  EXPECT_EQ(policy.delayAfter(31), 0.1);
  EXPECT_EQ(policy.delayAfter(1), 0.2);
}

class SupervisorTest : public ::testing::Test {
 protected:
  // Steps until the condition holds, or for ten seconds.
  template <typename Condition>
  bool until(Supervisor& supervisor, Condition condition) {
    for (int i = 0; i < 1000 && !condition(); ++i) {
      for (const std::string& line : supervisor.step()) said += line + "\n";
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return condition();
  }
  static ProcessRow shell(const std::string& name, Role role, const std::string& script,
                          bool reports = false) {
    return {name, "", reports ? "STATUS_X" : "", role, {"sh", "-c", script, "sh"}};
  }
  std::string output(const std::string& name) {
    std::ifstream in(folder / (name + ".txt"));
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  test::TempFolder folder;
  std::string said;
};

TEST_F(SupervisorTest, AProgramThatIsNotThereIsNamed) {
  Supervisor dut({{"x", "", "", Role::kStage, {"/nowhere/sgraphs-x"}}}, folder.path());
  try {
    dut.start(Role::kStage);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("/nowhere/sgraphs-x"), std::string::npos) << e.what();
  }
}

TEST_F(SupervisorTest, WhatDiesIsStartedAgainAndToldSo) {
  Supervisor dut({shell("x", Role::kStage, "echo life $@; sleep 30", true)}, folder.path());
  dut.start(Role::kStage);
  ASSERT_TRUE(until(dut, [&] { return output("x") == "life\n"; }));
  for (int i = 1; i <= 2; ++i) {
    const std::string before = output("x");
    ASSERT_EQ(std::system(("kill -9 " + std::to_string(dut.pidOf("x"))).c_str()), 0);
    ASSERT_TRUE(until(dut, [&] { return output("x") != before; })) << said;
    EXPECT_NE(output("x").find("life --boot " + std::to_string(i) + "\n"), std::string::npos) << output("x");
  }
  EXPECT_EQ(dut.restarts("x"), 2);
  EXPECT_NE(said.find("x ended with code 137 and is started again in 0.1 s: life"), std::string::npos)
      << said;
}

TEST_F(SupervisorTest, WhatEndsInOrderOrByItsCommandLineIsLeft) {
  Supervisor dut(
      {shell("done", Role::kStage, "exit 0"), shell("odd", Role::kStage, "exit 3"),
       shell("usage", Role::kStage, "echo unknown key; exit 2"), shell("player", Role::kPlayer, "exit 1")},
      folder.path());
  dut.start(Role::kStage);
  dut.start(Role::kPlayer);
  ASSERT_TRUE(until(dut, [&] { return !dut.running(Role::kStage) && !dut.running(Role::kPlayer); }));
  until(dut,
        [&] { return said.find("player") != std::string::npos && said.find("usage") != std::string::npos; });
  EXPECT_EQ(dut.restarts(), 0);
  EXPECT_EQ(dut.exitCode(Role::kStage), 3);
  EXPECT_NE(said.find("usage ended with code 2: unknown key"), std::string::npos) << said;
  EXPECT_FALSE(dut.endedEarly("odd"));
  EXPECT_TRUE(dut.endedEarly("usage"));
}

TEST_F(SupervisorTest, StoppedMeansNotStartedAgain) {
  Supervisor dut({shell("x", Role::kSource, "sleep 30")}, folder.path());
  dut.start(Role::kSource);
  EXPECT_TRUE(dut.running(Role::kSource));
  EXPECT_FALSE(dut.exitCode(Role::kSource));
  dut.stop(Role::kSource, SIGTERM);
  ASSERT_TRUE(until(dut, [&] { return !dut.running(Role::kSource); }));
  EXPECT_EQ(dut.exitCode(Role::kSource), 128 + SIGTERM);
  EXPECT_EQ(dut.restarts(), 0);
}

TEST_F(SupervisorTest, NoChildOutlivesIt) {
  pid_t pid = 0;
  {
    Supervisor dut({shell("x", Role::kSource, "exec sleep 30")}, folder.path());
    dut.start(Role::kSource);
    pid = dut.pidOf("x");
    ASSERT_EQ(kill(pid, 0), 0);
  }
  EXPECT_NE(kill(pid, 0), 0);
}

}  // namespace
}  // namespace sgraphs
