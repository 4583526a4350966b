#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/bus/journal.h"

namespace sgraphs {

// A bus whose reader can be killed and come back. What it hears is written to a journal before its handlers
// run; since a node is a function of what it heard, resume() makes it what it was: its handlers run over the
// journal, and what they publish is not sent again, but for the last record's, which may not have been.
// Sequence numbers so go on where they ended, and `boot` says that there was a restart. Decisions by a clock
// are told to the journal as notes.
class JournalBus : public Bus {
 public:
  // `inner` must outlive this. `path` of the journal; empty: none is kept. `boot`: restarts that the caller
  // knows of.
  JournalBus(Bus& inner, std::string path, int64_t boot = 0);

  void publish(const std::string& channel, Bytes bytes) override;
  void subscribe(const std::string& channel, Handler handler) override;
  bool dispatch(int timeout_ms) override { return inner_.dispatch(timeout_ms); }
  int64_t boot() const override { return boot_; }

  // `decide` runs whenever note(name) is called, and in its place in the order of messages when the journal
  // is read.
  void onNote(const std::string& name, std::function<void()> decide);
  void note(const std::string& name);

  // Lets the journal begin anew with the reader's own state whenever it has grown by `every_bytes`, so that
  // coming back takes no longer after hours than after seconds. `save` gives nothing while that cannot be;
  // `restore` throws Error for a state that is not this program's.
  void keepCheckpoints(int64_t every_bytes, std::function<std::optional<std::vector<uint8_t>>()> save,
                       std::function<void(Bytes)> restore);

  // To be called once, when all handlers are there. Returns the number of messages read from the journal. A
  // journal of which the end is not whole is used up to there. Throws Error if the journal cannot be read or
  // written.
  int64_t resume();
  // The session is over: the journal is removed.
  void forget();

 private:
  struct Line {
    std::vector<Handler> handlers;
  };
  void hear(const std::string& name, Bytes bytes);
  void handle(const std::string& name, Bytes bytes);
  void refuseOtherSession(Bytes session_message);
  void writeCheckpoint();
  void restoreCheckpoint(Bytes bytes);

  Bus& inner_;
  std::string path_;
  std::unique_ptr<JournalWriter> journal_;
  std::map<std::string, Line> lines_;
  int64_t checkpoint_bytes_ = 0;  // 0: none are kept
  int64_t next_checkpoint_ = 0;   // size of the journal that asks for the next
  std::function<std::optional<std::vector<uint8_t>>()> save_;
  std::function<void(Bytes)> restore_;
  int64_t boot_;
  int64_t session_ = 0;  // that the journal is of; 0: none yet
  bool muted_ = false;
};

}  // namespace sgraphs
