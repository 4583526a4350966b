#include "common/bus/journal_bus.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "common/base/error.h"
#include "common/base/state_archive.h"
#include "common/bus/channels.h"

namespace sgraphs {
namespace {

// Names of notes begin with what no channel's name does.
constexpr const char* kBoot = "!boot";
constexpr const char* kCheckpoint = "!checkpoint";

std::string noteName(const std::string& name) {
  return "!" + name;
}

}  // namespace

JournalBus::JournalBus(Bus& inner, std::string path, int64_t boot)
    : inner_(inner), path_(std::move(path)), boot_(boot) {}

void JournalBus::publish(const std::string& channel, Bytes bytes) {
  if (!muted_) inner_.publish(channel, bytes);
}

void JournalBus::subscribe(const std::string& channel, Handler handler) {
  const auto [line, is_new] = lines_.try_emplace(channel);
  line->second.handlers.push_back(std::move(handler));
  if (is_new) inner_.subscribe(channel, [this, channel](Bytes bytes) { hear(channel, bytes); });
}

void JournalBus::onNote(const std::string& name, std::function<void()> decide) {
  lines_[noteName(name)].handlers.push_back([decide = std::move(decide)](Bytes) { decide(); });
}

void JournalBus::note(const std::string& name) {
  hear(noteName(name), {});
}

void JournalBus::hear(const std::string& name, Bytes bytes) {
  if (name == channels::kSession.name) refuseOtherSession(bytes);
  if (journal_) {
    try {
      journal_->append(name, bytes);
    } catch (const Error& e) {
      spdlog::warn("{}; from now on this process cannot be resumed", e.what());
      forget();
    }
  }
  handle(name, bytes);
  if (journal_ && checkpoint_bytes_ > 0 && journal_->bytes() >= next_checkpoint_) writeCheckpoint();
}

void JournalBus::keepCheckpoints(int64_t every_bytes,
                                 std::function<std::optional<std::vector<uint8_t>>()> save,
                                 std::function<void(Bytes)> restore) {
  checkpoint_bytes_ = next_checkpoint_ = every_bytes;
  save_ = std::move(save);
  restore_ = std::move(restore);
}

// The new journal takes the old one's place when it is whole: killed in between, the old one counts.
void JournalBus::writeCheckpoint() {
  std::optional<std::vector<uint8_t>> state = save_();
  if (!state) return;
  StateArchive archive;
  archive(session_, *state);
  try {
    auto fresh = std::make_unique<JournalWriter>(path_ + ".new", 0);
    for (int64_t i = 0; i <= boot_; ++i) fresh->append(kBoot, {});
    fresh->append(kCheckpoint, archive.takeBytes());
    fresh->moveTo(path_);
    journal_ = std::move(fresh);
  } catch (const Error& e) {
    spdlog::warn("{}; the journal goes on without a checkpoint", e.what());
  }
  next_checkpoint_ = journal_->bytes() + checkpoint_bytes_;
}

void JournalBus::restoreCheckpoint(Bytes bytes) {
  try {
    if (!restore_) throw Error("this program keeps no checkpoints");
    StateArchive archive(bytes);
    std::vector<uint8_t> state;
    archive(session_, state);
    restore_(state);
  } catch (const Error& e) {
    const std::string why = e.what();
    forget();
    throw Error("journal '" + path_ + "': " + why + ": this process ends, and is to be started anew");
  }
}

void JournalBus::handle(const std::string& name, Bytes bytes) {
  const auto line = lines_.find(name);
  if (line == lines_.end()) return;
  for (const Handler& handler : line->second.handlers) handler(bytes);
}

// What the journal made this process is of no use to another session: it ends, and is started anew by whoever
// watches it.
void JournalBus::refuseOtherSession(Bytes session_message) {
  session_t m{};
  if (!decode(session_message, m) || m.header.session == 0) return;
  if (session_ == 0) session_ = m.header.session;
  if (session_ == m.header.session || !journal_) return;
  forget();
  throw Error("session " + std::to_string(m.header.session) + " has begun while session " +
              std::to_string(session_) + " had not ended: this process ends, and is to be started anew");
}

int64_t JournalBus::resume() {
  if (path_.empty()) return 0;
  // Read once to know which record is the last, and once more to work on them: a journal may be larger than
  // memory.
  int64_t messages = 0, boots = 0;
  JournalReader counter(path_);
  bool has_checkpoint = false;
  while (const auto record = counter.next()) {
    if (record->name == kCheckpoint)
      has_checkpoint = true;
    else
      ++(record->name == kBoot ? boots : messages);
  }
  if (counter.bytesLeft() > 0)
    spdlog::warn("journal '{}': its last {} bytes are not whole and are left out", path_,
                 counter.bytesLeft());
  const int64_t boot = std::max(boot_, boots);
  boot_ = std::max<int64_t>(boots - 1, 0);
  JournalReader reader(path_);
  for (int64_t left = messages; left > 0 || has_checkpoint;) {
    const std::optional<JournalRecord> record = reader.next();
    if (!record) throw Error("journal '" + path_ + "' changes while it is read: two processes of one kind?");
    if (record->name == kBoot) continue;
    if (record->name == kCheckpoint) {
      has_checkpoint = false;
      restoreCheckpoint(record->bytes);
      continue;
    }
    muted_ = --left > 0;
    if (record->name == channels::kSession.name) refuseOtherSession(record->bytes);
    handle(record->name, record->bytes);
  }
  muted_ = false;
  boot_ = boot;
  journal_ = std::make_unique<JournalWriter>(path_, counter.goodBytes());
  journal_->append(kBoot, {});
  next_checkpoint_ = journal_->bytes() + checkpoint_bytes_;
  return messages;
}

void JournalBus::forget() {
  journal_.reset();
  std::error_code none;
  if (!path_.empty()) std::filesystem::remove(path_, none);
}

}  // namespace sgraphs
