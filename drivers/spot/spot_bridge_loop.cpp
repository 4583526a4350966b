#include "drivers/spot/spot_bridge_loop.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "common/base/error.h"
#include "common/base/notify_ready.h"
#include "common/bus/lcm_bus.h"
#include "common/io/text_file.h"
#include "drivers/host_clock.h"
#include "drivers/session_source.h"
#include "drivers/spot/grpc_spot_robot.h"
#include "drivers/spot/spot_bridge_node.h"
#include "tools/system/stop_signals.h"

namespace sgraphs {
namespace {

constexpr int kMaxWait_ms = 50;
constexpr Duration kSecond{1'000'000};

Time steadyNow() {
  using std::chrono::steady_clock;
  return {
      std::chrono::duration_cast<std::chrono::microseconds>(steady_clock::now().time_since_epoch()).count()};
}

SpotBridgeConfig settingsOf(const ProcessSetup& setup, const SpotBridgeOptions& options) {
  SpotBridgeConfig config = setup.config.drivers.spot_bridge;
  if (!options.host.empty()) config.host = options.host;
  if (!options.root_cert.empty()) config.root_cert = options.root_cert;
  if (!options.credentials.empty()) config.credentials = options.credentials;
  if (!options.frame.empty()) setConfigValue(visitOf(config), "frame=" + options.frame);
  if (config.host.empty()) throw UsageError("give the robot's name or address: --host 192.168.80.3");
  if (config.root_cert.empty())
    throw UsageError(
        "give the certificate that signed the robot's: --root-cert FILE (docs/spot.md says where it is)");
  return config;
}

// A session in which the legs' odometry is used where there is any, unless the settings ask for `encoder`.
std::optional<Session> ownSession(const ProcessText& text, const ProcessSetup& setup,
                                  const SpotBridgeOptions& options) {
  if (!options.own_session) return std::nullopt;
  const SessionConfig& config = setup.config.drivers.session;
  if (config.T_body_lidar == SessionConfig{}.T_body_lidar)
    spdlog::warn("drivers.session.T_body_lidar is not set: the LiDAR counts as mounted at the body's origin");
  Session session = liveSession(config, text.name + " " SGRAPHS_VERSION, digestOf(setup.config), hostClock());
  session.has_odometry = true;
  if (session.odometry_mode == "lidar") session.odometry_mode.clear();
  return session;
}

}  // namespace

int runSpotBridge(const ProcessText& text, const ProcessSetup& setup, const SpotBridgeOptions& options) {
  const SpotBridgeConfig config = settingsOf(setup, options);
  const std::optional<Session> session = ownSession(text, setup, options);
  const Credentials credentials = readCredentials(config.credentials);
  GrpcSpotRobot robot({config.host, config.port, readFile(config.root_cert)},
                      Duration::fromSeconds(config.call_timeout_s));
  SpotBridge bridge(robot, config, credentials, steadyNow);
  LcmBus bus(setup.lcm_url);
  SpotBridgeNode node(bus, bridge, session, setup.boot, hostClock);
  StopSignals stop;
  node.everySecond();
  spdlog::info("listening");
  notifyReady();
  Time next_second = steadyNow() + kSecond;
  while (!node.done() && !stop.requested()) {
    const int64_t wait_ms = ((bridge.due() - steadyNow()).us + 999) / 1000;
    bus.dispatch(static_cast<int>(std::clamp<int64_t>(wait_ms, 0, kMaxWait_ms)));
    node.step();
    if (steadyNow() < next_second) continue;
    next_second = steadyNow() + kSecond;
    node.everySecond();
  }
  node.finish();
  return kExitDone;
}

}  // namespace sgraphs
