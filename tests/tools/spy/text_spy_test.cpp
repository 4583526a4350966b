#include "tools/spy/text_spy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "common/base/error.h"
#include "common/bus/channels.h"
#include "common/bus/lcm_bus.h"
#include "common/bus/log_file.h"
#include "tests/support/temp_folder.h"

namespace sgraphs::spy {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// What a run prints.
std::string output(const TextSpyOptions& options) {
  std::FILE* file = std::tmpfile();
  try {
    runTextSpy(options, file);
  } catch (...) {
    std::fclose(file);
    throw;
  }
  std::string text(static_cast<size_t>(std::ftell(file)), '\0');
  std::rewind(file);
  text.resize(std::fread(text.data(), 1, text.size(), file));
  std::fclose(file);
  return text;
}

std::string errorOf(const TextSpyOptions& options) {
  try {
    output(options);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

// Ten odometries, of which the fifth is missing, one map_to_odom that is spoiled, and a message of another
// program.
void writeLog(const std::string& path) {
  LogWriter log(path);
  for (int i = 0; i < 10; ++i) {
    odometry_t message{};
    message.header.session = 1;
    message.header.seq = i;
    message.scan = 40 + i;
    if (i != 4) write(log, 1'000'000 + 100'000 * i, channels::kOdometry, message);
  }
  const std::vector<uint8_t> spoiled(20, 1);
  log.write(2'000'000, "MAP_TO_ODOM", spoiled);
  log.write(2'000'000, "CAMERA", spoiled);
  log.close();
}

class TextSpyLogTest : public testing::Test {
 protected:
  TextSpyLogTest() {
    writeLog(folder_ / "run.lcmlog");
    options_.url = "file://" + (folder_ / "run.lcmlog") + "?speed=0";
  }
  test::TempFolder folder_;
  TextSpyOptions options_;
};

TEST_F(TextSpyLogTest, ALogBecomesATable) {
  const std::string text = output(options_);
  EXPECT_THAT(text, HasSubstr("ODOMETRY                     odometry_t                   9     8.89"));
  EXPECT_THAT(text, HasSubstr("CAMERA                       (not ours)                   1"));
  // One lost, none bad; one bad.
  EXPECT_THAT(text, testing::ContainsRegex("odometry_t .* 1       0 "));
  EXPECT_THAT(text, testing::ContainsRegex("map_to_odom_t .* 1 "));
}

TEST_F(TextSpyLogTest, TheMessagesOfAChannelArePrinted) {
  options_.channel = "ODOMETRY";
  const std::string all = output(options_);
  EXPECT_THAT(all, AllOf(HasSubstr("--- ODOMETRY 0, at 0.000 s"), HasSubstr("--- ODOMETRY 8, at 0.900 s")));
  EXPECT_THAT(all, AllOf(HasSubstr("scan: 40\n"), HasSubstr("scan: 49\n")));
  options_.duration_s = 0.25;
  EXPECT_THAT(output(options_), AllOf(HasSubstr("scan: 42\n"), Not(HasSubstr("scan: 43\n"))));
  options_.once = true;
  EXPECT_THAT(output(options_), AllOf(HasSubstr("scan: 40\n"), Not(HasSubstr("scan: 41\n"))));
  options_.duration_s.reset();
  options_.channel = "MAP_TO_ODOM";
  EXPECT_THAT(output(options_), HasSubstr("not a message of this version"));
}

TEST_F(TextSpyLogTest, WhatIsNotInTheLogIsAnError) {
  options_.channel = "ROOMS";
  EXPECT_THAT(errorOf(options_), AllOf(HasSubstr("no message of ROOMS"), HasSubstr("sgraphs log info")));
  options_.channel = "RUMS";
  EXPECT_THAT(errorOf(options_), HasSubstr("check its name"));
  options_.url = "file://" + (folder_ / "absent.lcmlog");
  EXPECT_THAT(errorOf(options_), HasSubstr("absent.lcmlog"));
}

// Publishes over UDP until it goes out of scope.
class Sender {
 public:
  explicit Sender(const std::string& url) : bus_(url), thread_([this] { run(); }) {}
  ~Sender() {
    stop_ = true;
    thread_.join();
  }

 private:
  void run() try {
    odometry_t message{};
    message.header.session = 1;
    for (; !stop_; ++message.header.seq) {
      publish(bus_, channels::kOdometry, message);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  } catch (const Error&) {
    // Without multicast the listener says so.
  }
  LcmBus bus_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

// A port of this process alone.
std::string ownUrl() {
  return "udpm://239.255.76.69:" + std::to_string(20000 + getpid() % 20000) + "?ttl=0";
}

TEST(TextSpyBusTest, ABusIsWatchedAndAMessagePrinted) {
  TextSpyOptions options;
  options.url = ownUrl();
  std::optional<Sender> sender;
  try {
    sender.emplace(options.url);
    options.once = true;
    options.duration_s = 0.5;
    EXPECT_THAT(output(options), testing::ContainsRegex("ODOMETRY +odometry_t +[0-9]+ "));
    options.channel = "ODOMETRY";
    EXPECT_THAT(output(options), AllOf(HasSubstr("--- ODOMETRY 0"), HasSubstr("T_odom_body:\n"),
                                       Not(HasSubstr("--- ODOMETRY 1,"))));
  } catch (const Error& e) {
    if (std::string(e.what()).find("multicast") != std::string::npos) GTEST_SKIP() << e.what();
    throw;
  }
}

TEST(TextSpyBusTest, SilenceIsAnErrorThatSaysWhatToCheck) {
  TextSpyOptions options;
  options.url = "memq://";
  options.once = true;
  options.duration_s = 0.1;
  EXPECT_THAT(errorOf(options),
              AllOf(HasSubstr("nothing heard on the bus 'memq://'"), HasSubstr("same URL")));
  options.channel = "ODOMETRY";
  EXPECT_THAT(errorOf(options), HasSubstr("nothing heard of ODOMETRY"));
}

}  // namespace
}  // namespace sgraphs::spy
