#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/bus/bus.h"
#include "common/bus/channels.h"
#include "common/bus/early_messages.h"
#include "common/bus/input_gate.h"
#include "common/bus/publisher.h"
#include "common/bus/status.h"
#include "common/types/session.h"

namespace sgraphs {

// What the stages behind the odometry do alike on a bus: they learn from SESSION whether they take part, hold
// back what comes before it, check what enters, number what they say, and report their health.
class StageIo {
 public:
  // `stage`: as SESSION names it ("free-space"); `process`: the program's name. The bus must outlive this.
  StageIo(Bus& bus, std::string stage, std::string process);

  // Messages of the channel go to the handler once SESSION is known and until close().
  template <typename Message, typename Handler>
  void listen(const Channel<Message>& channel, Handler handler) {
    early_.listen(bus_, gate_, channel, [this, handler](const Message& m) {
      if (!closed_) handler(m);
    });
  }
  // Nothing is heard any more.
  void close() { closed_ = true; }

  template <typename Message>
  void send(const Channel<Message>& channel, Message& message) {
    publisher_.send(channel, message);
  }

  // Header and sequence of a message that was heard: false if it must not be worked on.
  template <typename Message>
  bool accept(const Channel<Message>& channel, const Message& m, int64_t* lost_before = nullptr) {
    return gate_.accept(channel.name, m.header, lost_before);
  }
  template <typename Message>
  void reject(const Channel<Message>& channel, const std::string& why) {
    gate_.reject(channel.name, why);
  }

  bool closed() const { return closed_; }
  bool takesPart() const { return takes_part_; }
  const std::optional<Session>& session() const { return session_; }
  InputGate& gate() { return gate_; }
  const InputGate& gate() const { return gate_; }
  const Publisher& publisher() const { return publisher_; }

  void publishStatus(const Channel<status_t>& channel, Time newest, size_t queue_depth,
                     const LatencyHistogram& latency);

 private:
  void onSession(const session_t& m);

  Bus& bus_;
  std::string stage_, process_;
  Publisher publisher_;
  InputGate gate_;
  EarlyMessages early_;
  std::optional<Session> session_;
  bool takes_part_ = false;
  bool closed_ = false;
};

}  // namespace sgraphs
