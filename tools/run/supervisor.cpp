#include "tools/run/supervisor.h"

#include <signal.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "common/base/error.h"

namespace sgraphs {

Supervisor::Supervisor(std::vector<ProcessRow> rows, std::string log_dir)
    : rows_(std::move(rows)), log_dir_(std::move(log_dir)) {
  std::error_code failed;
  std::filesystem::create_directories(log_dir_, failed);
  if (failed) throw Error("cannot make folder '" + log_dir_ + "': " + failed.message());
  // What an earlier run said is not this one's.
  for (const ProcessRow& row : rows_) std::filesystem::remove(outputOf(row.name), failed);
}

void Supervisor::launch(const ProcessRow& row, State& state) {
  std::vector<std::string> command = row.command;
  if (state.restarts > 0 && !row.status_channel.empty())
    command.insert(command.end(), {"--boot", std::to_string(state.restarts)});
  state.child = std::make_unique<Child>(command, outputOf(row.name));
  state.since.restart();
  state.waits = false;
}

void Supervisor::start(Role role) {
  for (const ProcessRow& row : rows_) {
    if (row.role != role) continue;
    State& state = states_[row.name];
    state.wanted = true;
    launch(row, state);
  }
}

// A stage that has ended in order has heard RUN_RESULT; what ended because of its command line would do so
// again, and a player would begin again.
bool Supervisor::shouldRestart(const ProcessRow& row, int code) const {
  if (code == kExitUsage || row.role == Role::kPlayer) return false;
  if (row.role == Role::kSource || row.role == Role::kRecorder) return true;
  return code != kExitDone && code != kExitNotReproducible;
}

std::vector<std::string> Supervisor::step() {
  std::vector<std::string> said;
  for (const ProcessRow& row : rows_) {
    State& state = states_[row.name];
    if (!state.wanted || !state.child) continue;
    if (state.waits) {
      if (state.since.elapsedSeconds() < state.wait_s) continue;
      ++state.restarts;
      launch(row, state);
      continue;
    }
    const std::optional<int> code = state.child->exitCode();
    if (!code) continue;
    const std::string last = lastLineOf(outputOf(row.name));
    if (!shouldRestart(row, *code)) {
      state.wanted = false;
      if (*code != kExitDone && *code != kExitNotReproducible)
        said.push_back(row.name + " ended with code " + std::to_string(*code) + ": " + last);
      continue;
    }
    state.wait_s = state.policy.delayAfter(state.since.elapsedSeconds());
    state.waits = true;
    state.since.restart();
    char delay[16];
    std::snprintf(delay, sizeof delay, "%.1f", state.wait_s);
    said.push_back(row.name + " ended with code " + std::to_string(*code) + " and is started again in " +
                   delay + " s: " + last);
  }
  return said;
}

void Supervisor::stop(Role role, int signal) {
  for (const ProcessRow& row : rows_) {
    State& state = states_[row.name];
    if (row.role != role) continue;
    state.wanted = state.waits = false;
    if (state.child) state.child->signal(signal);
  }
}

void Supervisor::kill(Role role) {
  stop(role, SIGKILL);
}

bool Supervisor::running(Role role) {
  return std::any_of(rows_.begin(), rows_.end(), [&](const ProcessRow& row) {
    State& state = states_[row.name];
    return row.role == role && state.child && (state.waits || !state.child->exitCode());
  });
}

std::optional<int> Supervisor::exitCode(Role role) {
  if (running(role)) return std::nullopt;
  int worst = 0;
  for (const ProcessRow& row : rows_) {
    State& state = states_[row.name];
    if (row.role == role && state.child) worst = std::max(worst, state.child->exitCode().value_or(0));
  }
  return worst;
}

bool Supervisor::endedEarly(const std::string& name) {
  State& state = states_[name];
  const std::optional<int> code = state.child ? state.child->exitCode() : std::nullopt;
  return code && !state.waits && *code != kExitDone && *code != kExitNotReproducible;
}

int Supervisor::restarts(const std::string& name) const {
  const auto state = states_.find(name);
  return state == states_.end() ? 0 : state->second.restarts;
}

int Supervisor::restarts() const {
  int sum = 0;
  for (const auto& [name, state] : states_) sum += state.restarts;
  return sum;
}

}  // namespace sgraphs
