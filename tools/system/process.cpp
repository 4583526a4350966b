#include "tools/system/process.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <thread>
#include <vector>

#include "common/base/error.h"
#include "common/base/notify_ready.h"
#include "common/base/performance.h"
#include "common/types/session.h"
#include "tools/system/stop_signals.h"

namespace sgraphs {
namespace {

constexpr double kEndOverdue_s = 30;
constexpr int kPoll_ms = 100;
constexpr int kPollAwaiting_ms = 10;

// Runs what is to be done when something was awaited for too long.
class Deadline {
 public:
  explicit Deadline(const Awaited& awaited) : awaited_(awaited) {}

  // Whether anything is awaited.
  bool check() {
    const int64_t now = awaited_.number();
    if (now < 0 || now != number_) {
      number_ = now;
      waiting_.restart();
    } else if (waiting_.elapsedSeconds() > awaited_.patience_s()) {
      if (!awaited_.said.empty()) spdlog::warn("{} {}", number_, awaited_.said);
      awaited_.give_up();
      waiting_.restart();
    }
    return now >= 0;
  }

 private:
  const Awaited& awaited_;
  int64_t number_ = -1;
  Stopwatch waiting_;
};

std::string journalIn(const std::string& folder, const std::string& name) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw Error("cannot make folder '" + folder + "': " + failed.message());
  return folder + "/" + name + ".journal";
}

int failed(const std::string& name, const std::exception& e, int code) {
  std::fprintf(stderr, "%s: %s\n", name.c_str(), e.what());
  return code;
}

void addStageOptions(CLI::App& app, ProcessSetup& setup, int& threads, std::string& state_dir) {
  app.add_option("--state-dir", state_dir,
                 "Folder for the journal that this process resumes from when it was killed");
  app.add_option("--threads", threads, "Worker threads; the result does not depend on it")
      ->check(CLI::Range(1, 64));
  app.add_option("--odometry", setup.odometry, "lidar, encoder or fused in place of SESSION's choice");
  app.add_flag("--stay", setup.stay, "Do not exit when the stream has ended");
  app.add_option("--end-after-silence", setup.end_after_silence_s,
                 "End the stream after so many seconds without a message; 0: never")
      ->check(CLI::NonNegativeNumber);
}

}  // namespace

int runProcess(const ProcessText& text, int argc, char** argv,
               const std::function<int(const ProcessSetup&)>& body) {
  spdlog::set_default_logger(spdlog::stderr_logger_mt(text.name));
  spdlog::set_pattern("%n: %v");
  ProcessSetup setup;
  std::string config_file;
  std::vector<std::string> assignments;
  int threads = 0;
  CLI::App app(text.purpose, text.name);
  app.footer("Example:\n  " + text.example);
  app.set_version_flag("--version", text.name + " " SGRAPHS_VERSION);
  app.add_option("--lcm-url", setup.lcm_url, "LCM provider; default: $LCM_DEFAULT_URL, else LCM's own");
  app.add_option("--config", config_file, "YAML file of settings");
  app.add_option("--set", assignments, "One setting, section.key=value; may be repeated");
  app.add_option("--boot", setup.boot, "How often this process was restarted within the session")
      ->check(CLI::NonNegativeNumber);
  std::string state_dir;
  if (text.stage) addStageOptions(app, setup, threads, state_dir);
  bool print_config = false;
  app.add_flag("--print-config", print_config, "Print the configuration in force and exit");
  if (text.may_be_live)
    app.add_flag("--live", setup.live,
                 "Rounds have a deadline (live.deadline_s): a late stage joins the next one");
  if (text.add_options) text.add_options(app);
  if (text.writes_output) app.add_option("-o,--output", setup.output_dir, "Folder to write the result to");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kExitDone : kExitUsage;
  }
  try {
    // Before any other thread exists, so that all of them inherit it.
    blockStopSignals();
    if (!config_file.empty()) loadConfigFile(visitOf(setup.config), config_file);
    for (const std::string& assignment : assignments) setConfigValue(visitOf(setup.config), assignment);
    if (threads > 0) setup.config.odometry.threads = threads;
    if (!setup.odometry.empty()) parseOdometryMode(setup.odometry);
    if (!state_dir.empty()) setup.journal = journalIn(state_dir, text.name);
    if (print_config) {
      std::fputs(configToYaml(visitOf(setup.config)).c_str(), stdout);
      return kExitDone;
    }
    return body(setup);
  } catch (const UsageError& e) {
    return failed(text.name, e, kExitUsage);
  } catch (const std::exception& e) {
    return failed(text.name, e, kExitFailed);
  }
}

void runLoop(JournalBus& bus, const ProcessSetup& setup, const LoopHooks& hooks) {
  StopSignals signals;
  Stopwatch status, silence, overdue;
  std::vector<Deadline> deadlines(hooks.awaited.begin(), hooks.awaited.end());
  bool heard = false, awaiting = false;
  if (const int64_t resumed = bus.resume(); resumed > 0)
    spdlog::warn("was killed and is back: {} messages from its journal, {:.1f} s", resumed,
                 status.elapsedSeconds());
  hooks.publish_status();
  spdlog::info("listening");
  notifyReady();
  while (!hooks.done() || setup.stay) {
    if (signals.requested()) {
      hooks.finish("stopped by a signal");
      break;
    }
    if (bus.dispatch(awaiting ? kPollAwaiting_ms : kPoll_ms)) {
      heard = true;
      silence.restart();
      overdue.restart();
    }
    awaiting = false;
    for (Deadline& deadline : deadlines) awaiting = deadline.check() || awaiting;
    if (!hooks.overdue()) overdue.restart();
    if (overdue.elapsedSeconds() > kEndOverdue_s)
      hooks.finish("the end of the stream did not arrive within 30 s");
    if (heard && setup.end_after_silence_s > 0 && silence.elapsedSeconds() > setup.end_after_silence_s)
      hooks.finish("no message for " + std::to_string(silence.elapsedUs() / 1'000'000) + " s");
    if (status.elapsedSeconds() < 1.0) continue;
    hooks.publish_status();
    status.restart();
  }
  hooks.publish_status();
  bus.forget();
}

int leaveAfterEnd(const ProcessText& text, const std::function<void()>& repeat_end,
                  const std::string& why_not) {
  for (int i = 0; i < 3; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    repeat_end();
  }
  if (why_not.empty()) return kExitDone;
  std::fprintf(stderr, "%s: not reproducible: %s\n", text.name.c_str(), why_not.c_str());
  return kExitNotReproducible;
}

}  // namespace sgraphs
