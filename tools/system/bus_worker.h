#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/memory_bus.h"

namespace sgraphs {

// Delivers messages to a bus, in the order they are handed in: at once, or on a thread of its own, so that
// whoever hands them in works on meanwhile. The bus sees the same order either way.
class BusWorker {
 public:
  static constexpr size_t kMaxWaiting = 1000;  // messages; whoever hands in more waits

  // The bus must outlive the worker, and belongs to it until finish().
  BusWorker(MemoryBus& bus, bool own_thread);
  ~BusWorker();
  BusWorker(const BusWorker&) = delete;
  BusWorker& operator=(const BusWorker&) = delete;

  // Throws what a handler of an earlier message threw.
  void deliver(const std::string& channel, Bus::Bytes bytes);
  // Returns when everything is delivered. Throws as deliver().
  void finish();

 private:
  struct Item {
    std::string channel;
    std::vector<uint8_t> bytes;
  };
  void run();
  void stop();

  MemoryBus& bus_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> waiting_;
  bool ending_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace sgraphs
