#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace sgraphs {

// Most bytes of a message that is made of records, so that it stays one datagram.
inline constexpr int kMaxRecordsBytes = 60000;

// Fills message after message with records up to the bytes of a datagram. Every message repeats `head`.
template <typename Message>
class ChunkFiller {
 public:
  explicit ChunkFiller(const Message& head) : head_(head) { begin(); }

  // A record that is a message type of its own.
  template <typename Record>
  void add(std::vector<Record> Message::*records, const Record& record) {
    makeRoom(record.getEncodedSize());
    (chunks_.back().*records).push_back(record);
  }
  void add(std::vector<int64_t> Message::*records, int64_t record) {
    makeRoom(sizeof record);
    (chunks_.back().*records).push_back(record);
  }
  // Two vectors that belong together.
  void add(std::vector<int64_t> Message::*first, int64_t a, std::vector<int64_t> Message::*second,
           int64_t b) {
    makeRoom(2 * sizeof a);
    (chunks_.back().*first).push_back(a);
    (chunks_.back().*second).push_back(b);
  }

  // The messages, numbered; `count` sets the lengths of a message's vectors.
  template <typename Count>
  std::vector<Message> finish(Count count) {
    for (size_t i = 0; i < chunks_.size(); ++i) {
      chunks_[i].chunk = static_cast<int32_t>(i);
      chunks_[i].num_chunks = static_cast<int32_t>(chunks_.size());
      count(chunks_[i]);
    }
    return std::move(chunks_);
  }

 private:
  void begin() {
    chunks_.push_back(head_);
    bytes_ = head_.getEncodedSize();
  }
  // A member's encoded size counts its fingerprint, which is not sent inside a message: the sum errs upwards.
  void makeRoom(int bytes) {
    if (bytes_ + bytes > kMaxRecordsBytes) begin();
    bytes_ += bytes;
  }

  Message head_;
  std::vector<Message> chunks_;
  int bytes_ = 0;
};

// Collects the chunks of one round's message. Rounds come one after the other: what a newer one finds
// incomplete is given up.
template <typename Message>
class RoundAssembly {
 public:
  static constexpr int kMaxChunks = 1000;

  // All chunks of the round, in order, once the last has come. `refused` is set for a chunk that cannot be.
  std::optional<std::vector<Message>> add(const Message& chunk, bool& refused) {
    refused = chunk.num_chunks < 1 || chunk.num_chunks > kMaxChunks || chunk.chunk < 0 ||
              chunk.chunk >= chunk.num_chunks || chunk.round < round_;
    if (refused) return std::nullopt;
    if (chunk.round > round_) chunks_.clear();
    round_ = chunk.round;
    refused = (!chunks_.empty() && chunks_.begin()->second.num_chunks != chunk.num_chunks) ||
              !chunks_.try_emplace(chunk.chunk, chunk).second;
    if (refused || static_cast<int32_t>(chunks_.size()) < chunk.num_chunks) return std::nullopt;
    std::vector<Message> all;
    for (auto& [index, m] : chunks_) all.push_back(std::move(m));
    chunks_.clear();
    ++round_;  // a repetition is refused
    return all;
  }

 private:
  int64_t round_ = 0;
  std::map<int32_t, Message> chunks_;
};

}  // namespace sgraphs
