#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace sgraphs {

// Decides what joins a round, by id and never by arrival. An input is a channel whose outputs are keyed: by
// the keyframe, or by the round whose GRAPH_UPDATE they were made of. Pure bookkeeping: the outputs
// themselves stay with the caller.
class RoundJoiner {
 public:
  enum class Mode {
    kWait,  // a round waits for all its inputs, lost ones excepted
    kLive,  // take() may be called earlier (deadline); what comes late joins the next round
  };
  // One input's output: the key it was made for, and the sequence number of its last message.
  struct Output {
    std::string input;
    int64_t key = 0;
    int64_t seq = 0;
    bool operator==(const Output&) const = default;
  };
  struct Joined {
    std::vector<Output> outputs;       // by input, then key
    std::vector<std::string> missing;  // inputs that the round went without
  };
  // The key that each input's output must have to join the round.
  using Wants = std::map<std::string, int64_t>;

  static constexpr size_t kMaxHeld = 1000;  // outputs per input
  static constexpr size_t kMaxSchedules = 1'000'000;

  explicit RoundJoiner(Mode mode = Mode::kWait) : mode_(mode) {}

  // An output has arrived completely. False if its round went without it (wait mode), if the key was there
  // before, or if too many are held: the caller refuses it.
  bool arrived(const Output& output);
  // The output of this key will never come.
  void lost(const std::string& input, int64_t key);
  // A recorded run let exactly these outputs (input and seq) join this round: obeyed in place of the keys.
  void schedule(int64_t round, const std::vector<Output>& outputs);
  // What the schedule of this round asks for and has not come will never come.
  void releaseSchedule(int64_t round);
  // Rounds are governed by schedules: what is late for its own round is kept, since a later one may ask for
  // it.
  void expectSchedules() { obeys_schedules_ = true; }
  // Newest round that a schedule has come for; -1: none.
  int64_t newestSchedule() const { return newest_schedule_; }

  bool ready(int64_t round, const Wants& wants) const;
  // Closes the round: hands out what joins it.
  Joined take(int64_t round, const Wants& wants);
  // No round to come can use outputs up to this key.
  void forget(const std::string& input, int64_t key);

 private:
  struct Line {
    std::map<int64_t, int64_t> held;  // key -> seq
    std::set<int64_t> lost;
    int64_t newest_seq = -1;
    int64_t closed_key = -1;  // newest key that a round was closed for
  };
  // Key of the held output with this number; -1: none.
  static int64_t keyOf(const Line& line, int64_t seq);
  // The output has come, or a later one of its channel has, so that it never will.
  bool settled(const std::string& input, int64_t seq) const;
  Joined takeScheduled(const std::map<std::string, std::set<int64_t>>& scheduled);

  Mode mode_;
  bool obeys_schedules_ = false;
  int64_t newest_schedule_ = -1;
  std::set<int64_t> released_;  // rounds whose schedules wait for nothing any more
  std::map<std::string, Line> lines_;
  std::map<int64_t, std::map<std::string, std::set<int64_t>>> schedules_;  // round -> input -> seqs
};

}  // namespace sgraphs
