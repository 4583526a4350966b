#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/base/time.h"
#include "common/geometry/se3.h"

namespace sgraphs::test {

// Body in odom at one instant, with its velocity in axes of odom.
struct FakeMotion {
  SE3 T_odom_body;
  Eigen::Vector3d linear_odom_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_odom_radps = Eigen::Vector3d::Zero();
};

// T_vision_odom of every fake robot.
SE3 fakeVisionOdom();

// How the poses of a state hang together. "vision" hangs in all of them.
enum class FakeFrames {
  kBodyRoot,  // as a robot does: odom and vision are children of body
  kOdomRoot,  // the other way round
  kDeep,      // odom and body far apart, on two branches below a third
  kNoOdom,
  kCircle,
};

// Calls that the robot has seen.
struct FakeCalls {
  int logins = 0, refused_logins = 0, renewals = 0, time_syncs = 0, states = 0;
  int wrong_authority = 0;  // of a service other than the one called
  int without_token = 0;
};

struct FakeRobotOptions {
  std::string user = "walker";
  std::string password = "tick-tock-42";
  int port = 0;                            // 0: a free one
  Duration state_period{3000};             // a new state so often
  std::function<FakeMotion(Time)> motion;  // at a host time; empty: stands at the origin
};

// A robot that speaks the wire of drivers/spot/proto: TLS with a certificate of its own, services told apart
// by authority, tokens, a clock, states. It misbehaves on command, at any time and from any thread.
class FakeRobot {
 public:
  explicit FakeRobot(const FakeRobotOptions& options);
  ~FakeRobot();

  int port() const;
  const std::string& rootCertPem() const;
  FakeCalls calls() const;
  std::string lastToken() const;

  // The robot's clock is ahead of the host's by this.
  void setClockOffset(Duration offset);
  void setClockServiceReady(bool ready);
  void setFrames(FakeFrames frames);
  void setNanPoses(bool nan);
  void setFrozenState(bool frozen);  // the same acquisition over and over
  // States take this long to answer.
  void setSlowness(Duration slowness);
  // States are answered by an error whose text repeats the password and the token.
  void setTalkative(bool talkative);
  void setLockedOut(bool locked_out);
  void setPassword(const std::string& password);
  // No token given so far is valid any more.
  void expireTokens();
  // Every connection breaks, and there is nobody at the port until start().
  void stop();
  void start();

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace sgraphs::test
