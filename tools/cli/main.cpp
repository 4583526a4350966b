#include <CLI/CLI.hpp>
#include <cstdio>

#include "common/base/error.h"
#include "tools/cli/commands.h"

namespace {

constexpr char kExamples[] =
    "Examples:\n"
    "  sgraphs simulate small_office -o run.lcmlog --truth truth --with-odometry\n"
    "  sgraphs convert --pcap lidar.pcap --odometry-tum odom.tum --T-body-lidar '0 0 0.3 0 0 0 1' -o "
    "run.lcmlog\n"
    "  sgraphs replay run.lcmlog -o OUT\n"
    "  sgraphs eval OUT --truth truth\n"
    "  sgraphs run --record recordings -o OUT\n"
    "Every command has --help with an example. Exit codes: 0 done, 1 failed, 2 wrong usage or configuration, "
    "3 done but not reproducible.";

int failed(const char* what, int code) {
  std::fprintf(stderr, "sgraphs: %s\n", what);
  return code;
}

int run(int argc, char** argv) {
  using namespace sgraphs;
  CLI::App app("Situational graphs: LiDAR packets and legged odometry become a map and a trajectory",
               "sgraphs");
  app.set_version_flag("--version", "sgraphs " SGRAPHS_VERSION);
  app.footer(kExamples);
  app.require_subcommand(1);
  cli::addSimulate(app);
  cli::addConvert(app);
  cli::addReplay(app);
  cli::addEval(app);
  cli::addLog(app);
  cli::addBench(app);
  cli::addSpy(app);
  cli::addSend(app);
  cli::addRun(app);
  cli::addDoctor(app);
  cli::addReserved(app);
  try {
    app.parse(argc, argv);
    return kExitDone;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success))
      return app.exit(e);  // --help, --version
    return failed((std::string(e.what()) + "; `sgraphs --help` shows the usage").c_str(), kExitUsage);
  } catch (const cli::ExitCode& e) {
    return e.code;
  } catch (const UsageError& e) {
    return failed(e.what(), kExitUsage);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    return failed(e.what(), sgraphs::kExitFailed);
  }
}
