#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "sgraphs/graph_update_t.hpp"
#include "sgraphs/rooms_t.hpp"
#include "sgraphs/run_result_t.hpp"
#include "sgraphs/status_t.hpp"

namespace sgraphs {

// What a run's messages say of its health, as text. Pure: the caller has the clock.
class StatusBoard {
 public:
  void status(const std::string& channel, const status_t& m, double now_s);
  void graphUpdate(const graph_update_t& m);
  void rooms(const rooms_t& m);
  // A message of a channel whose rate is shown.
  void count(const std::string& channel) { ++counts_[channel]; }
  // Rates are those since the call before.
  void takeRates(double now_s);

  // A process has been heard of.
  bool knows(const std::string& channel) const { return processes_.contains(channel); }

  // What the run has come to, in one line.
  std::string summary(double now_s) const;
  // The screen: the summary, a table with a row per process (`restarts`: by status channel).
  std::vector<std::string> screen(double now_s, const std::map<std::string, int>& restarts) const;

  int64_t rounds() const { return rounds_; }
  int64_t keyframes() const { return keyframes_; }
  int64_t roomsSoFar() const { return rooms_; }

 private:
  struct Process {
    status_t newest;
    double heard_s = 0;
  };
  double rate(const std::string& channel) const;

  std::map<std::string, Process> processes_;  // by status channel
  std::map<std::string, int64_t> counts_, counts_before_;
  std::map<std::string, double> rates_;
  double rates_s_ = 0;
  int64_t rounds_ = 0, keyframes_ = 0, rooms_ = 0, doorways_ = 0, floors_ = 0;
};

}  // namespace sgraphs
