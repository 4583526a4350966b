#include "backend/round_joiner.h"

#include <algorithm>

namespace sgraphs {

bool RoundJoiner::arrived(const Output& output) {
  Line& line = lines_[output.input];
  line.newest_seq = std::max(line.newest_seq, output.seq);
  const bool late = mode_ == Mode::kWait && !obeys_schedules_ && output.key <= line.closed_key;
  if (late || line.held.size() >= kMaxHeld) return false;
  return line.held.try_emplace(output.key, output.seq).second;
}

void RoundJoiner::lost(const std::string& input, int64_t key) {
  Line& line = lines_[input];
  if (key > line.closed_key && !line.held.contains(key)) line.lost.insert(key);
}

void RoundJoiner::schedule(int64_t round, const std::vector<Output>& outputs) {
  if (schedules_.size() >= kMaxSchedules) return;
  obeys_schedules_ = true;
  newest_schedule_ = std::max(newest_schedule_, round);
  auto& scheduled = schedules_[round];
  for (const Output& output : outputs) scheduled[output.input].insert(output.seq);
}

void RoundJoiner::releaseSchedule(int64_t round) {
  if (schedules_.contains(round)) released_.insert(round);
}

void RoundJoiner::forget(const std::string& input, int64_t key) {
  Line& line = lines_[input];
  line.held.erase(line.held.begin(), line.held.upper_bound(key));
  line.lost.erase(line.lost.begin(), line.lost.upper_bound(key));
  line.closed_key = std::max(line.closed_key, key);
}

int64_t RoundJoiner::keyOf(const Line& line, int64_t seq) {
  const auto found =
      std::find_if(line.held.begin(), line.held.end(), [seq](const auto& h) { return h.second == seq; });
  return found == line.held.end() ? -1 : found->first;
}

// Numbers are consecutive per channel: a higher one that has come means that a missing one is lost.
bool RoundJoiner::settled(const std::string& input, int64_t seq) const {
  const auto line = lines_.find(input);
  return line != lines_.end() && line->second.newest_seq >= seq;
}

bool RoundJoiner::ready(int64_t round, const Wants& wants) const {
  const auto scheduled = schedules_.find(round);
  if (scheduled != schedules_.end())
    return released_.contains(round) ||
           std::all_of(scheduled->second.begin(), scheduled->second.end(), [this](const auto& of_input) {
             return std::all_of(of_input.second.begin(), of_input.second.end(),
                                [&](int64_t seq) { return settled(of_input.first, seq); });
           });
  return std::all_of(wants.begin(), wants.end(), [this](const auto& want) {
    const auto line = lines_.find(want.first);
    return line != lines_.end() &&
           (line->second.held.contains(want.second) || line->second.lost.contains(want.second));
  });
}

RoundJoiner::Joined RoundJoiner::take(int64_t round, const Wants& wants) {
  const auto scheduled = schedules_.find(round);
  Joined joined;
  if (scheduled != schedules_.end()) {
    joined = takeScheduled(scheduled->second);
    schedules_.erase(schedules_.begin(), std::next(scheduled));
    released_.erase(released_.begin(), released_.upper_bound(round));
    for (const auto& [input, key] : wants) {
      Line& line = lines_[input];
      line.closed_key = std::max(line.closed_key, key);
    }
    return joined;
  }
  for (const auto& [input, key] : wants) {
    Line& line = lines_[input];
    if (!line.held.contains(key)) joined.missing.push_back(input);
    // In live mode late outputs of earlier rounds join as well; in wait mode there are none.
    const auto end = line.held.upper_bound(key);
    for (auto it = line.held.begin(); it != end; ++it)
      joined.outputs.push_back({input, it->first, it->second});
    line.held.erase(line.held.begin(), end);
    line.lost.erase(line.lost.begin(), line.lost.upper_bound(key));
    line.closed_key = std::max(line.closed_key, key);
  }
  return joined;
}

RoundJoiner::Joined RoundJoiner::takeScheduled(const std::map<std::string, std::set<int64_t>>& scheduled) {
  Joined joined;
  for (const auto& [input, seqs] : scheduled) {
    Line& line = lines_[input];
    for (const int64_t seq : seqs) {
      const int64_t key = keyOf(line, seq);
      if (key < 0) {
        joined.missing.push_back(input);
        continue;
      }
      joined.outputs.push_back({input, key, seq});
      line.held.erase(key);
    }
  }
  return joined;
}

}  // namespace sgraphs
