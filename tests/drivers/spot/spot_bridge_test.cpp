// The bridge against a robot that misbehaves: over gRPC and TLS, on a bus in memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <iostream>
#include <limits>
#include <sstream>
#include <thread>

#include "common/base/error.h"
#include "common/bus/memory_bus.h"
#include "drivers/host_clock.h"
#include "drivers/spot/grpc_spot_robot.h"
#include "drivers/spot/spot_bridge_node.h"
#include "lcmtypes/convert/convert.h"
#include "tests/drivers/spot/fake_robot.h"

namespace sgraphs {
namespace {

using test::FakeFrames;
using test::FakeMotion;
using test::FakeRobot;
using test::FakeRobotOptions;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int64_t kSession = 4711;
constexpr Duration kHourAhead{3'600'123'456};
// Far more than any step takes here; a test ends when what it waits for has happened.
constexpr double kPatience_s = 30;
// A clock on a busy machine is known to some milliseconds; the robot walks 0.5 m/s.
constexpr double kPoseTolerance_m = 0.05;

// Round and round at 0.5 m/s, with a full turn every 12.6 s of host time.
FakeMotion walk(Time host) {
  const double angle = 0.5 * static_cast<double>(host.us % 12'566'370'614) * 1e-6;
  FakeMotion motion;
  motion.T_odom_body = {so3Exp({0, 0, angle}), {std::sin(angle), 1 - std::cos(angle), 0.5}};
  motion.linear_odom_mps = motion.T_odom_body.rotation * Eigen::Vector3d(0.5, 0, 0);
  motion.angular_odom_radps = {0, 0, 0.5};
  return motion;
}

FakeRobotOptions walking() {
  FakeRobotOptions options;
  options.motion = walk;
  return options;
}

class SpotBridgeTest : public ::testing::Test {
 protected:
  SpotBridgeTest() : robot_(walking()) {
    config_.host = "127.0.0.1";
    config_.call_timeout_s = 5;  // a busy machine is no slow robot
    config_.reconnect_first_s = 0.05;
    config_.reconnect_max_s = 0.2;
    robot_.setClockOffset(kHourAhead);
    logger_ = spdlog::default_logger();
    auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(said_);
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("sgraphs-spot-bridge", sink));
    spdlog::set_pattern("%n: %v");
    const auto ignore = [] {};
    subscribe(
        bus_, channels::kSpotOdometry, [this](const spot_odometry_t& m) { odometry_.push_back(m); }, ignore);
    subscribe(
        bus_, channels::kPoseSpot, [this](const pose_t& m) { poses_.push_back(m); }, ignore);
    subscribe(
        bus_, channels::kStatusSpotBridge, [this](const status_t& m) { status_ = m; }, ignore);
    subscribe(
        bus_, channels::kSession, [this](const session_t& m) { sessions_.push_back(m); }, ignore);
    subscribe(
        bus_, channels::kStreamEnd, [this](const stream_end_t& m) { ends_.push_back(m); }, ignore);
  }
  ~SpotBridgeTest() override {
    spdlog::set_default_logger(logger_);
    std::cout << said();
    if (status_) std::cout << "last STATUS_SPOT_BRIDGE: " << status_->state << "\n";
    // Whatever happened: no secret was said.
    for (const std::string& secret : {credentials_.password, robot_.lastToken()}) {
      if (secret.empty()) continue;
      EXPECT_THAT(said(), Not(HasSubstr(secret)));
      EXPECT_THAT(status_ ? status_->state : "", Not(HasSubstr(secret)));
    }
  }

  void makeNode(const std::optional<Session>& own = std::nullopt) {
    client_ = std::make_unique<GrpcSpotRobot>(SpotAddress{"127.0.0.1", robot_.port(), root_cert_},
                                              Duration::fromSeconds(config_.call_timeout_s));
    bridge_ = std::make_unique<SpotBridge>(*client_, config_, credentials_, [this] { return steadyNow(); });
    node_ = std::make_unique<SpotBridgeNode>(bus_, *bridge_, own, 0, hostClock);
  }
  void sendSession() {
    Session session;
    session.id = kSession;
    session.start = hostClock();
    session.has_odometry = true;
    publish(bus_, channels::kSession, toMessage(session, hostClock()));
  }
  // Runs until it is so.
  template <typename Predicate>
  void runUntil(Predicate reached, const char* what) {
    if (!node_) {
      makeNode();
      sendSession();
    }
    const Stopwatch watch;
    while (!reached()) {
      ASSERT_LT(watch.elapsedSeconds(), kPatience_s) << "waited in vain for: " << what << "\n" << state();
      bus_.dispatch(0);
      node_->step();
      bus_.dispatch(0);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  void runUntilSamples(size_t more) {
    const size_t count = odometry_.size() + more;
    runUntil([&] { return odometry_.size() >= count; }, "samples");
  }
  void runUntilState(const std::string& text) {
    runUntil([&] { return state().find(text) != std::string::npos; }, text.c_str());
  }
  void runUntilStates(int more) {
    const int count = robot_.calls().states + more;
    runUntil([&] { return robot_.calls().states >= count; }, "states asked for");
  }
  std::string state() {
    node_->everySecond();
    bus_.dispatch(0);
    return status_->state;
  }
  std::string said() const { return said_.str(); }
  int64_t timesSaid(const std::string& text) const {
    int64_t times = 0;
    const std::string all = said();
    for (size_t at = all.find(text); at != std::string::npos; at = all.find(text, at + 1)) ++times;
    return times;
  }
  int64_t row(const std::string& name, std::vector<int64_t> status_t::*column) {
    state();
    for (size_t i = 0; i < status_->channel.size(); ++i)
      if (status_->channel[i] == name) return ((*status_).*column)[i];
    return -1;
  }
  // Samples are numbered without a gap, later and later, and where the robot was at their stamps.
  void expectTrueSamples(const SE3& T_frame_odom = {}) {
    int64_t last_us = 0, seq = 0;
    for (const spot_odometry_t& m : odometry_) {
      EXPECT_EQ(m.header.seq, seq++);
      EXPECT_GT(m.header.utime, last_us);
      last_us = m.header.utime;
      const std::optional<BodyOdometry> sample = fromMessage(m);
      ASSERT_TRUE(sample);
      const SE3 expected = T_frame_odom * walk(sample->time).T_odom_body;
      EXPECT_LT((sample->T_odom_body.translation - expected.translation).norm(), kPoseTolerance_m);
    }
    ASSERT_EQ(poses_.size(), odometry_.size());
    for (size_t i = 0; i < poses_.size(); ++i) {
      const pose_t& m = poses_[i];
      EXPECT_EQ(m.utime, odometry_[i].header.utime);
      const double expected[] = {0.5, 0, 0, 0, 0, 0.5};
      for (int a = 0; a < 3; ++a) {
        EXPECT_EQ(m.pos[a], odometry_[i].T_odom_body.xyz[a]);
        EXPECT_NEAR(m.vel[a], expected[a], 1e-9);
        EXPECT_NEAR(m.rotation_rate[a], expected[3 + a], 1e-9);
      }
    }
  }
  Time steadyNow() const {
    using std::chrono::steady_clock;
    return Time{std::chrono::duration_cast<std::chrono::microseconds>(steady_clock::now().time_since_epoch())
                    .count()} +
           skipped_;
  }

  FakeRobot robot_;
  SpotBridgeConfig config_;
  Credentials credentials_{"walker", "tick-tock-42"};
  std::string root_cert_ = robot_.rootCertPem();
  Duration skipped_;  // of the bridge's pauses
  MemoryBus bus_;
  std::unique_ptr<GrpcSpotRobot> client_;
  std::unique_ptr<SpotBridge> bridge_;
  std::unique_ptr<SpotBridgeNode> node_;
  std::vector<spot_odometry_t> odometry_;
  std::vector<pose_t> poses_;
  std::vector<session_t> sessions_;
  std::vector<stream_end_t> ends_;
  std::optional<status_t> status_;

 private:
  std::ostringstream said_;
  std::shared_ptr<spdlog::logger> logger_;
};

TEST_F(SpotBridgeTest, PublishesWhereTheRobotWasAtTheStampsOfTheHost) {
  runUntilSamples(50);
  expectTrueSamples();
  EXPECT_EQ(odometry_.front().header.session, kSession);
  EXPECT_THAT(state(), HasSubstr("running: odom, skew 36001"));
  EXPECT_THAT(state(), HasSubstr("0.50 m/s"));
  EXPECT_EQ(row("robot-state", &status_t::rejected), 0);
  EXPECT_EQ(robot_.calls().logins, 1);
  EXPECT_GE(robot_.calls().time_syncs, 4);
  EXPECT_EQ(robot_.calls().wrong_authority, 0);
}

TEST_F(SpotBridgeTest, TakesTheVisionFrameIfAsked) {
  config_.frame = "vision";
  runUntilSamples(10);
  expectTrueSamples(test::fakeVisionOdom());
}

TEST_F(SpotBridgeTest, TheDirectionOfEdgesAndThePlaceOfTheRootDoNotMatter) {
  for (const FakeFrames frames : {FakeFrames::kOdomRoot, FakeFrames::kDeep, FakeFrames::kBodyRoot}) {
    robot_.setFrames(frames);
    runUntilSamples(10);
  }
  expectTrueSamples();
  EXPECT_EQ(row("robot-state", &status_t::rejected), 0);
}

TEST_F(SpotBridgeTest, HoldsBackUntilThereIsASession) {
  makeNode();
  runUntil([&] { return bridge_->synced(); }, "synchronised clocks");
  for (int i = 0; i < 50; ++i) node_->step();
  EXPECT_THAT(state(), HasSubstr("waiting for SESSION"));
  EXPECT_EQ(robot_.calls().states, 0);
  sendSession();
  runUntilSamples(3);
  EXPECT_EQ(odometry_.front().header.seq, 0);
}

TEST_F(SpotBridgeTest, HoldsBackUntilTheClocksAreSynchronised) {
  robot_.setClockServiceReady(false);
  runUntilState("not synchronised: the robot's clock service is not ready");
  const int rounds = robot_.calls().time_syncs;
  skipped_ = {2'000'000};
  runUntil([&] { return robot_.calls().time_syncs > rounds; }, "another round");
  EXPECT_TRUE(odometry_.empty());
  EXPECT_EQ(robot_.calls().states, 0);
  robot_.setClockServiceReady(true);
  skipped_ = {4'000'000};
  runUntilSamples(5);
  expectTrueSamples();
}

TEST_F(SpotBridgeTest, AWrongPasswordIsTheEndAfterOneTry) {
  credentials_.password = "tick-tack-43";
  makeNode();
  sendSession();
  std::string error;
  const auto work = [&] {
    try {
      node_->step();
    } catch (const Error& e) {
      error = e.what();
    }
    return !error.empty();
  };
  runUntil(work, "the end");
  EXPECT_THAT(error, HasSubstr("the robot refuses user and password"));
  EXPECT_THAT(error, Not(HasSubstr("tick")));
  EXPECT_EQ(error.find('\n'), std::string::npos);
  EXPECT_EQ(robot_.calls().refused_logins, 1);
  std::cout << "ends with: " << error << "\n";
}

TEST_F(SpotBridgeTest, WaitsOutALockout) {
  robot_.setLockedOut(true);
  runUntilState("the robot has locked the account out: next login in 6");
  for (int i = 0; i < 100; ++i) node_->step();
  EXPECT_EQ(robot_.calls().logins, 1);
  robot_.setLockedOut(false);
  skipped_ = {66'000'000};
  runUntilSamples(3);
  EXPECT_EQ(robot_.calls().logins, 2);
}

TEST_F(SpotBridgeTest, LogsInAgainWhenTheTokenExpires) {
  runUntilSamples(5);
  robot_.expireTokens();
  runUntilSamples(5);
  EXPECT_EQ(robot_.calls().logins, 2);
  EXPECT_THAT(said(), HasSubstr("does not accept the token any more: logging in again"));
  expectTrueSamples();
}

TEST_F(SpotBridgeTest, APasswordChangedOnTheRobotIsTriedOnce) {
  runUntilSamples(2);
  robot_.setPassword("another");
  robot_.expireTokens();
  EXPECT_THROW(runUntilSamples(1000), Error);
  EXPECT_EQ(robot_.calls().refused_logins, 1);
}

TEST_F(SpotBridgeTest, RenewsTheTokenBeforeItExpires) {
  runUntilSamples(2);
  const std::string first = robot_.lastToken();
  skipped_ = {3'600'000'000};
  runUntilSamples(2);
  EXPECT_EQ(robot_.calls().renewals, 1);
  EXPECT_EQ(robot_.calls().logins, 1);
  EXPECT_NE(robot_.lastToken(), first);
}

TEST_F(SpotBridgeTest, AClockThatJumpsIsNoticedBeforeAWrongStampGoesOut) {
  runUntilSamples(10);
  robot_.setClockOffset({-7'000'000});
  runUntilSamples(10);
  robot_.setClockOffset(kHourAhead);
  skipped_ = {6'000'000};
  runUntilSamples(10);
  expectTrueSamples();
  EXPECT_EQ(timesSaid("a clock was set: the robot's is ahead by"), 2);
  EXPECT_GE(row("robot-state", &status_t::rejected), 2);
}

TEST_F(SpotBridgeTest, MissingFramesAreNamedOnceAndWaitedFor) {
  robot_.setFrames(FakeFrames::kNoOdom);
  runUntilStates(5);
  EXPECT_EQ(timesSaid("robot-state: no frame 'odom'"), 1);
  EXPECT_EQ(state(), "no odometry: no frame 'odom'");
  robot_.setFrames(FakeFrames::kCircle);
  runUntilStates(5);
  EXPECT_EQ(timesSaid("go in a circle"), 1);
  EXPECT_TRUE(odometry_.empty());
  robot_.setFrames(FakeFrames::kBodyRoot);
  runUntilSamples(5);
  EXPECT_THAT(state(), HasSubstr("running"));
}

TEST_F(SpotBridgeTest, PosesThatAreNotFiniteDoNotPass) {
  runUntilSamples(5);
  const size_t before = odometry_.size();
  robot_.setNanPoses(true);
  runUntil([&] { return row("robot-state", &status_t::rejected) >= 5; }, "refused states");
  EXPECT_LE(odometry_.size(), before + 1);
  EXPECT_EQ(timesSaid("the pose of frame 'odom' is not finite"), 1);
  robot_.setNanPoses(false);
  runUntilSamples(5);
  expectTrueSamples();
}

TEST_F(SpotBridgeTest, TheSameStateTwiceIsPublishedOnce) {
  config_.max_stamp_error_s = 10;  // a busy machine may ask for it late
  runUntilSamples(2);
  robot_.setFrozenState(true);
  runUntil([&] { return row("robot-state, repeated", &status_t::count) >= 5; }, "repeated states");
  EXPECT_LE(odometry_.size(), 4u);
  robot_.setFrozenState(false);
  runUntilSamples(2);
  expectTrueSamples();
}

TEST_F(SpotBridgeTest, AnOldStateIsNotMistakenForANewOne) {
  robot_.setFrozenState(true);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  runUntil([&] { return row("robot-state", &status_t::rejected) >= 3; }, "refused states");
  EXPECT_TRUE(odometry_.empty());
  EXPECT_EQ(timesSaid("a clock jumped, or the state is old"), 1);
  EXPECT_THAT(state(), HasSubstr("not synchronised: stamps -"));
}

TEST_F(SpotBridgeTest, SlowAnswersAreGivenUpAndTheConnectionMadeAnew) {
  config_.call_timeout_s = 0.2;
  runUntilSamples(3);
  robot_.setSlowness({400'000});
  runUntilState("no connection to 127.0.0.1: no answer within the deadline");
  EXPECT_GE(row("robot-state", &status_t::lost), 3);
  robot_.setSlowness({0});
  runUntilSamples(5);
  expectTrueSamples();
  EXPECT_THAT(said(), HasSubstr("connected to 127.0.0.1"));
}

TEST_F(SpotBridgeTest, ABrokenConnectionIsMadeAgainWithGrowingPauses) {
  runUntilSamples(5);
  robot_.stop();
  runUntilState("no connection to 127.0.0.1");
  runUntil([&] { return row("time-sync", &status_t::lost) + row("directory", &status_t::lost) >= 4; },
           "tries");
  EXPECT_EQ(timesSaid("no connection to"), 1);
  robot_.start();
  runUntilSamples(5);
  expectTrueSamples();
  EXPECT_EQ(timesSaid("connected to 127.0.0.1"), 1);
  EXPECT_EQ(robot_.calls().logins, 1);
}

TEST_F(SpotBridgeTest, ARobotThatComesLaterIsFound) {
  robot_.stop();
  runUntilState("no connection to 127.0.0.1");
  EXPECT_EQ(robot_.calls().logins, 0);
  robot_.start();
  runUntilSamples(3);
}

TEST_F(SpotBridgeTest, TheWrongCertificateIsNamedAndNoPasswordSent) {
  root_cert_ = FakeRobot(walking()).rootCertPem();
  runUntilState("no connection to 127.0.0.1");
  EXPECT_THAT(said(), HasSubstr("the robot's certificate is not signed by the one of --root-cert"));
  EXPECT_EQ(robot_.calls().logins, 0);
}

TEST_F(SpotBridgeTest, SecretsThatTheRobotRepeatsAreNotSaid) {
  runUntilSamples(2);
  robot_.setTalkative(true);
  runUntil([&] { return row("robot-state", &status_t::rejected) >= 2; }, "refused states");
  EXPECT_EQ(timesSaid("failed for password *** and token ***"), 1);
  EXPECT_THAT(state(), HasSubstr("failed for password *** and token ***"));
}

TEST_F(SpotBridgeTest, AnOwnSessionIsPublishedAndEnded) {
  Session own;
  own.id = 99;
  own.start = hostClock();
  own.writer = "test";
  own.has_odometry = true;
  own.T_body_lidar = SE3(Eigen::Quaterniond::Identity(), {0.1, 0, 0.3});
  makeNode(own);
  runUntilSamples(3);
  node_->everySecond();
  node_->finish();
  bus_.dispatch(0);
  ASSERT_EQ(sessions_.size(), 2u);
  EXPECT_EQ(sessions_[1].header.seq, 1);
  EXPECT_EQ(fromMessage(sessions_[0])->T_body_lidar.translation.z(), 0.3);
  ASSERT_EQ(ends_.size(), 3u);
  EXPECT_EQ(ends_[0].channel, (std::vector<std::string>{"SESSION", "SPOT_ODOMETRY"}));
  EXPECT_EQ(ends_[0].last_seq[1], odometry_.back().header.seq);
  EXPECT_EQ(odometry_.back().header.session, 99);
}

TEST_F(SpotBridgeTest, TwoSourcesOfSessionAreAnError) {
  Session own;
  own.id = 99;
  makeNode(own);
  sendSession();
  EXPECT_THROW(bus_.dispatch(0), Error);
}

TEST_F(SpotBridgeTest, EndsWithItsSessionOnly) {
  runUntilSamples(1);
  stream_end_t end{};
  end.header.session = kSession + 1;
  publish(bus_, channels::kStreamEnd, end);
  runUntilSamples(1);
  EXPECT_FALSE(node_->done());
  end.header.session = kSession;
  publish(bus_, channels::kStreamEnd, end);
  bus_.dispatch(0);
  EXPECT_TRUE(node_->done());
  EXPECT_EQ(state(), "done");
}

}  // namespace
}  // namespace sgraphs
