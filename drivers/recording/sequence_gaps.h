#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "sgraphs/header_t.hpp"

namespace sgraphs {

// Messages of one channel that are missing by their sequence numbers.
class SequenceGaps {
 public:
  // from_beginning: the first message ought to be the channel's first; else what came before it is not asked
  // for.
  explicit SequenceGaps(bool from_beginning) : from_beginning_(from_beginning) {}

  // Number of messages missing just before this one. A restarted publisher begins at 0 again.
  int64_t step(const header_t& header) {
    const bool restarted = last_ && (header.boot != last_->boot || header.session != last_->session);
    int64_t expected = header.seq;
    if (last_ && !restarted)
      expected = last_->seq + 1;
    else if (last_ || from_beginning_)
      expected = 0;
    last_ = header;
    return std::max<int64_t>(0, header.seq - expected);
  }

 private:
  bool from_beginning_;
  std::optional<header_t> last_;
};

}  // namespace sgraphs
