#pragma once

#include <cstdint>
#include <functional>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace sgraphs {

// The one seam between nodes and the world. Three implementations: LcmBus (any LCM provider URL), LogBus (a
// log file), MemoryBus (encoded bytes within one process). Single-threaded: handlers run inside dispatch().
class Bus {
 public:
  using Bytes = std::span<const uint8_t>;
  using Handler = std::function<void(Bytes)>;

  virtual ~Bus() = default;

  // Sends encoded bytes; throws Error if the transport refuses them.
  virtual void publish(const std::string& channel, Bytes bytes) = 0;

  // Calls the handler for each message of exactly this channel (no pattern), in order of arrival.
  virtual void subscribe(const std::string& channel, Handler handler) = 0;

  // Waits up to timeout_ms for messages and runs their handlers. Returns whether any ran. An exception that a
  // handler throws leaves this function once the transport's own code has returned.
  virtual bool dispatch(int timeout_ms) = 0;

  // How often the process that speaks through this bus was restarted within the session.
  virtual int64_t boot() const { return 0; }
};

// A channel that knows the type of its messages, so that the wrong type does not compile (see channels.h).
template <typename Message>
struct Channel {
  const char* name;
};

template <typename Message>
std::vector<uint8_t> encoded(const Message& message) {
  std::vector<uint8_t> bytes(static_cast<size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

template <typename Message>
void publish(Bus& bus, const Channel<Message>& channel, const Message& message) {
  bus.publish(channel.name, encoded(message));
}

// Decodes one message; false if the bytes are not a message of this type, or hold more than one.
template <typename Message>
bool decode(Bus::Bytes bytes, Message& message) {
  try {
    return message.decode(bytes.data(), 0, static_cast<int>(bytes.size())) == static_cast<int>(bytes.size());
  } catch (const std::length_error&) {
    // LCM's generated code sizes its vectors by counts that it has not checked: negative ones,
    return false;
  } catch (const std::bad_alloc&) {
    // or ones beyond any memory.
    return false;
  }
}

// Handler for decoded messages; bytes that do not decode go to on_undecodable (counted and named by the
// caller).
template <typename Message, typename Function>
void subscribe(Bus& bus, const Channel<Message>& channel, Function handler,
               const std::function<void()>& on_undecodable) {
  bus.subscribe(channel.name, [handler, on_undecodable](Bus::Bytes bytes) {
    Message message{};
    if (decode(bytes, message))
      handler(message);
    else
      on_undecodable();
  });
}

}  // namespace sgraphs
