// The legs' clock is off by a constant in a simulated recording: it is found, used, and the same on every
// replay.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace sgraphs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class ClockOffsetRunTest : public ::testing::TestWithParam<int> {
 protected:
  ClockOffsetRunTest()
      : folder_(fs::path(::testing::TempDir()) / ("clock_offset_test_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~ClockOffsetRunTest() override { fs::remove_all(folder_); }

  void run(const std::string& command) const {
    const fs::path said = folder_ / "said.txt";
    const int status =
        std::system((SGRAPHS_BINARY_DIR "/sgraphs " + command + " > '" + said.string() + "' 2>&1").c_str());
    std::ifstream in(said);
    ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0)
        << command << ":\n"
        << std::string(std::istreambuf_iterator<char>(in), {});
  }
  Json replay(const std::string& name, const std::string& options) const {
    run("replay " + quoted("run.lcmlog") + " -o " + quoted(name) + " --layers keyframes " + options);
    std::ifstream in(folder_ / name / "summary.json");
    return Json::parse(in);
  }
  std::string quoted(const std::string& name) const { return "'" + (folder_ / name).string() + "'"; }

  fs::path folder_;
};

TEST_P(ClockOffsetRunTest, IsFoundToThreeMillisecondsAndTheSameOnEveryReplay) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a minute of walking takes too long under a sanitizer; shorter runs cover the same code";
#endif
  const double offset_ms = GetParam();
  run("simulate two_rooms --with-odometry --set legs.clock_offset_s=" + std::to_string(1e-3 * offset_ms) +
      " -o " + quoted("run.lcmlog"));
  const Json one = replay("one", "--threads 1");
  EXPECT_NEAR(one["legs_clock"]["offset_ms"].get<double>(), offset_ms, 3.0);
  if (GetParam() == 0) {
    EXPECT_EQ(one["legs_clock"]["in_force_ms"].get<double>(), 0.0);
    const Json off = replay("off", "--set odometry.clock.estimate=false");
    EXPECT_FALSE(off.contains("legs_clock"));
    EXPECT_EQ(off["graph_digest"], one["graph_digest"]) << "what is right is left alone";
  } else {
    EXPECT_NEAR(one["legs_clock"]["in_force_ms"].get<double>(), offset_ms, 5.0);
    const Json two = replay("two", "--threads 2");
    EXPECT_EQ(one["graph_digest"], two["graph_digest"]);
    EXPECT_EQ(one["legs_clock"], two["legs_clock"]);
  }
}

INSTANTIATE_TEST_SUITE_P(Milliseconds, ClockOffsetRunTest, testing::Values(-50, 0, 50),
                         [](const auto& param_info) {
                           return std::string(param_info.param < 0 ? "Minus" : "Plus") +
                                  std::to_string(std::abs(param_info.param));
                         });

}  // namespace
}  // namespace sgraphs
