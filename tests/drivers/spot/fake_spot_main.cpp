// A robot for people who have none: serves the odometry of a recording to sgraphs-spot-bridge.
#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include "common/base/error.h"
#include "common/io/text_file.h"
#include "drivers/host_clock.h"
#include "tests/drivers/spot/fake_trajectory.h"
#include "tools/system/stop_signals.h"

namespace sgraphs::test {
namespace {

struct Options {
  FakeRobotOptions robot;
  std::string tum, log, folder = ".";
  double clock_offset_s = 0;
};

// Round and round, 0.5 m/s, in a circle of 1 m.
FakeMotion circle(Time host) {
  const double angle = 0.5 * static_cast<double>(host.us % 1'000'000'000'000) * 1e-6;
  FakeMotion motion;
  motion.T_odom_body = {so3Exp({0, 0, std::remainder(angle, 2 * M_PI)}),
                        {std::sin(angle), 1 - std::cos(angle), 0.5}};
  motion.linear_odom_mps = motion.T_odom_body.rotation * Eigen::Vector3d(0.5, 0, 0);
  motion.angular_odom_radps = {0, 0, 0.5};
  return motion;
}

int run(Options& options) {
  blockStopSignals();
  StopSignals stop;
  options.robot.motion = circle;
  if (!options.tum.empty() || !options.log.empty()) {
    const FakeTrajectory walk(options.log.empty() ? readTum(options.tum) : readOdometryOfLog(options.log),
                              hostClock());
    options.robot.motion = [walk](Time host) { return walk.at(host); };
  }
  FakeRobot robot(options.robot);
  robot.setClockOffset(Duration::fromSeconds(options.clock_offset_s));
  const std::string certificate = options.folder + "/fake_spot.pem",
                    credentials = options.folder + "/fake_spot.env";
  writeFile(certificate, robot.rootCertPem());
  writeFile(credentials, "SGRAPHS_SPOT_USER=" + options.robot.user +
                             "\nSGRAPHS_SPOT_PASSWORD=" + options.robot.password + "\n");
  chmod(credentials.c_str(), S_IRUSR | S_IWUSR);
  std::printf(
      "sgraphs-spot-bridge --host 127.0.0.1 --set drivers.spot_bridge.port=%d --root-cert %s --credentials "
      "%s\n",
      robot.port(), certificate.c_str(), credentials.c_str());
  std::fflush(stdout);
  while (!stop.requested()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  return kExitDone;
}

}  // namespace
}  // namespace sgraphs::test

int main(int argc, char** argv) {
  sgraphs::test::Options options;
  CLI::App app("Plays a Spot on 127.0.0.1 until SIGINT; prints how to start the bridge to it",
               "sgraphs-fake-spot");
  app.footer("Example:\n  sgraphs-fake-spot --log run.lcmlog --folder /tmp");
  CLI::Option* tum =
      app.add_option("--tum", options.tum, "Walk to play once in real time; default: a circle");
  app.add_option("--log", options.log, "The same from a log's SPOT_ODOMETRY")->excludes(tum);
  app.add_option("--port", options.robot.port, "TCP port; default: a free one");
  app.add_option("--folder", options.folder, "Where fake_spot.pem and fake_spot.env are written")
      ->capture_default_str();
  app.add_option("--clock-offset", options.clock_offset_s, "Robot's clock ahead of the host's by this [s]");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? sgraphs::kExitDone : sgraphs::kExitUsage;
  }
  try {
    return sgraphs::test::run(options);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "sgraphs-fake-spot: %s\n", e.what());
    return sgraphs::kExitFailed;
  }
}
