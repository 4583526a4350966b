#pragma once

#include <CLI/CLI.hpp>

namespace sgraphs::cli {

// Each function adds one subcommand, with its help and its example, whose callback does the work. A callback
// returns by throwing Error, UsageError, or ExitCode where the code is not 0.
struct ExitCode {
  int code;
};

void addConvert(CLI::App& app);
void addSimulate(CLI::App& app);
void addReplay(CLI::App& app);
void addEval(CLI::App& app);
void addLog(CLI::App& app);
void addBench(CLI::App& app);
void addSpy(CLI::App& app);
void addSend(CLI::App& app);
void addRun(CLI::App& app);
void addDoctor(CLI::App& app);
void addReserved(CLI::App& app);

}  // namespace sgraphs::cli
