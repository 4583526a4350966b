#include "tools/system/bus_worker.h"

#include <utility>

namespace sgraphs {

BusWorker::BusWorker(MemoryBus& bus, bool own_thread) : bus_(bus) {
  if (own_thread) thread_ = std::thread([this] { run(); });
}

BusWorker::~BusWorker() {
  stop();
}

void BusWorker::deliver(const std::string& channel, Bus::Bytes bytes) {
  if (!thread_.joinable()) {
    bus_.publish(channel, bytes);
    bus_.dispatch(0);
    return;
  }
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return waiting_.size() < kMaxWaiting || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  waiting_.push_back({channel, {bytes.begin(), bytes.end()}});
  changed_.notify_all();
}

void BusWorker::finish() {
  stop();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void BusWorker::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void BusWorker::run() {
  try {
    while (true) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return !waiting_.empty() || ending_; });
      if (waiting_.empty()) return;
      const Item item = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      changed_.notify_all();
      bus_.publish(item.channel, item.bytes);
      bus_.dispatch(0);
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
  changed_.notify_all();
}

}  // namespace sgraphs
