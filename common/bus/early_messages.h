#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/bus.h"
#include "common/bus/input_gate.h"

namespace sgraphs {

// What comes before SESSION is held back, in order of arrival: SESSION alone says which session a run belongs
// to, and it comes from another process than the other channels.
class EarlyMessages {
 public:
  static constexpr size_t kMaxHeld = 2000;

  // Subscribes to the channel: messages go to the handler, or wait for open(). What is too much or
  // undecodable is rejected at the gate. Bus, gate and this must outlive the subscription.
  template <typename Message, typename Handler>
  void listen(Bus& bus, InputGate& gate, const Channel<Message>& channel, Handler handler) {
    const std::string name = channel.name;
    const auto on_message = [this, &gate, name, handler](const Message& m) {
      if (open_)
        handler(m);
      else if (held_.size() < kMaxHeld)
        held_.push_back([handler, m] { handler(m); });
      else
        gate.reject(name, "before SESSION");
    };
    subscribe(bus, channel, on_message, [&gate, name] { gate.reject(name, "undecodable"); });
  }

  // SESSION is known: hands out what waits; from now on nothing does.
  void open() {
    open_ = true;
    for (const auto& handle : std::exchange(held_, {})) handle();
  }

 private:
  bool open_ = false;
  std::vector<std::function<void()>> held_;
};

}  // namespace sgraphs
