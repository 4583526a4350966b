#include "common/bus/memory_bus.h"

namespace sgraphs {

void MemoryBus::publish(const std::string& channel, Bytes bytes) {
  // A channel that nobody reads costs nothing.
  if (handlers_.contains(channel)) queue_.push_back({channel, {bytes.begin(), bytes.end()}});
}

void MemoryBus::subscribe(const std::string& channel, Handler handler) {
  handlers_[channel].push_back(std::move(handler));
}

bool MemoryBus::dispatch(int /*timeout_ms*/) {
  bool any = false;
  while (!queue_.empty()) {
    const Item item = std::move(queue_.front());
    queue_.pop_front();
    for (const Handler& handler : handlers_.at(item.channel)) handler(item.bytes);
    any = true;
  }
  return any;
}

}  // namespace sgraphs
