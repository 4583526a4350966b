#pragma once

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "common/bus/bus.h"

namespace sgraphs {

// Encoded bytes within one process, first in, first out: what a handler publishes is delivered after the
// messages already queued. Every run delivers the same messages in the same order.
class MemoryBus : public Bus {
 public:
  void publish(const std::string& channel, Bytes bytes) override;
  void subscribe(const std::string& channel, Handler handler) override;
  // Runs handlers until no message is left; the timeout is not used, nothing can arrive from outside.
  bool dispatch(int timeout_ms) override;

 private:
  struct Item {
    std::string channel;
    std::vector<uint8_t> bytes;
  };
  std::deque<Item> queue_;
  std::map<std::string, std::vector<Handler>> handlers_;
};

}  // namespace sgraphs
