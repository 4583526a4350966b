#include "drivers/spot/spot_bridge_command.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/random.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "common/base/error.h"
#include "common/base/stop_signal.h"
#include "common/bus/lcm_bus.h"
#include "common/io/parse_transform.h"
#include "common/io/text_file.h"
#include "drivers/spot/grpc_spot_robot.h"
#include "drivers/spot/spot_bridge_node.h"
#include "tools/system/system_config.h"

namespace sgraphs {
namespace {

constexpr const char* kName = "sgraphs-spot-bridge";
constexpr int kMaxWait_ms = 50;

struct Options {
  std::string lcm_url, config_file, T_body_lidar;
  std::vector<std::string> assignments;
  int64_t boot = 0;
  bool own_session = false, print_config = false;
  // In place of the configuration's, where they are given.
  std::string host, root_cert, credentials, frame;
};

Time steadyNow() {
  using std::chrono::steady_clock;
  return {
      std::chrono::duration_cast<std::chrono::microseconds>(steady_clock::now().time_since_epoch()).count()};
}

void declare(CLI::App& app, Options& options) {
  app.footer(
      "User and password come from SGRAPHS_SPOT_USER and SGRAPHS_SPOT_PASSWORD, or from --credentials FILE "
      "(chmod 600).\n"
      "Example:\n  sgraphs-spot-bridge --host 192.168.80.3 --root-cert robot.pem --credentials spot.env");
  app.set_version_flag("--version", std::string(kName) + " " SGRAPHS_VERSION);
  app.add_option("--host", options.host, "Name or address of the robot");
  app.add_option("--root-cert", options.root_cert, "PEM file of the certificate that signed the robot's");
  app.add_option("--credentials", options.credentials,
                 "File with user and password, readable by its owner only");
  app.add_option("--frame", options.frame, "odom (default) or vision");
  app.add_flag("--session", options.own_session, "Publish SESSION, too; default: wait for one on the bus");
  app.add_option("--T-body-lidar", options.T_body_lidar,
                 "With --session: LiDAR's mount on the body, \"x y z qx qy qz qw\"");
  app.add_option("--boot", options.boot, "How often this process was restarted within the session")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--lcm-url", options.lcm_url, "LCM provider; default: $LCM_DEFAULT_URL, else LCM's own");
  app.add_option("--config", options.config_file,
                 "YAML file of settings; the bridge's are drivers.spot_bridge");
  app.add_option("--set", options.assignments, "One setting, section.key=value; may be repeated");
  app.add_flag("--print-config", options.print_config, "Print the configuration in force and exit");
}

SystemConfig configOf(const Options& options) {
  SystemConfig config;
  if (!options.config_file.empty()) loadConfigFile(visitOf(config), options.config_file);
  std::vector<std::string> assignments = options.assignments;
  const auto set = [&](const std::string& key, const std::string& value) {
    if (!value.empty()) assignments.push_back("drivers.spot_bridge." + key + "=" + value);
  };
  set("host", options.host);
  set("root_cert", options.root_cert);
  set("credentials", options.credentials);
  set("frame", options.frame);
  for (const std::string& assignment : assignments) setConfigValue(visitOf(config), assignment);
  return config;
}

int64_t drawnId() {
  uint64_t id = 0;
  while (id == 0) {
    if (getrandom(&id, sizeof id, 0) != static_cast<ssize_t>(sizeof id))
      throw Error("cannot draw a session's id");
    id >>= 1;
  }
  return static_cast<int64_t>(id);
}

std::optional<Session> ownSession(const Options& options) {
  if (!options.own_session) return std::nullopt;
  if (options.T_body_lidar.empty())
    throw UsageError("--session needs --T-body-lidar: where the LiDAR is mounted on the body");
  Session session;
  session.id = drawnId();
  session.start = hostNow();
  session.writer = std::string(kName) + " " SGRAPHS_VERSION;
  session.has_odometry = true;
  session.T_body_lidar = parseTransform(options.T_body_lidar, "--T-body-lidar");
  return session;
}

int run(const Options& options) {
  const SystemConfig system = configOf(options);
  const SpotBridgeConfig& config = system.drivers.spot_bridge;
  if (config.host.empty()) throw UsageError("give the robot's name or address: --host 192.168.80.3");
  if (config.root_cert.empty())
    throw UsageError(
        "give the certificate that signed the robot's: --root-cert FILE (docs/spot.md says where it is)");
  const std::optional<Session> session = ownSession(options);
  const Credentials credentials = readCredentials(config.credentials);
  GrpcSpotRobot robot({config.host, config.port, readFile(config.root_cert)},
                      Duration::fromSeconds(config.call_timeout_s));
  SpotBridge bridge(robot, config, credentials, steadyNow);
  LcmBus bus(options.lcm_url);
  SpotBridgeNode node(bus, bridge, session, options.boot, hostNow);
  StopSignal stop;
  node.everySecond();
  spdlog::info("listening");
  Time next_second = steadyNow();
  while (!node.done() && !stop.requested()) {
    const int64_t wait_ms = ((bridge.due() - steadyNow()).us + 999) / 1000;
    bus.dispatch(static_cast<int>(std::clamp<int64_t>(wait_ms, 0, kMaxWait_ms)));
    node.step();
    if (steadyNow() < next_second) continue;
    next_second = steadyNow() + Duration{1'000'000};
    node.everySecond();
  }
  node.finish();
  return kExitDone;
}

int failed(const std::exception& e, int code) {
  std::fprintf(stderr, "%s: %s\n", kName, e.what());
  return code;
}

}  // namespace

int runSpotBridge(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_logger_mt(kName));
  spdlog::set_pattern("%n: %v");
  Options options;
  CLI::App app("The odometry of a Spot becomes SPOT_ODOMETRY on the LCM bus", kName);
  declare(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kExitDone : kExitUsage;
  }
  try {
    if (options.print_config) {
      SystemConfig config = configOf(options);
      std::fputs(configToYaml(visitOf(config)).c_str(), stdout);
      return kExitDone;
    }
    StopSignal::block();
    return run(options);
  } catch (const UsageError& e) {
    return failed(e, kExitUsage);
  } catch (const std::exception& e) {
    return failed(e, kExitFailed);
  }
}

}  // namespace sgraphs
