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

  bool ready(int64_t round, const Wants& wants) const;
  // Closes the round: hands out what joins it.
  Joined take(int64_t round, const Wants& wants);

 private:
  struct Line {
    std::map<int64_t, int64_t> held;  // key -> seq
    std::set<int64_t> lost;
    int64_t newest_seq = -1;
    int64_t closed_key = -1;  // newest key that a round was closed for
  };
  // Key of the held output with this number; -1: none.
  static int64_t keyOf(const Line& line, int64_t seq);
  Joined takeScheduled(const std::map<std::string, std::set<int64_t>>& scheduled);

  Mode mode_;
  std::map<std::string, Line> lines_;
  std::map<int64_t, std::map<std::string, std::set<int64_t>>> schedules_;  // round -> input -> seqs
};

}  // namespace sgraphs
