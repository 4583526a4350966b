#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.h"

namespace lcm {
class LCM;
}

namespace sgraphs {

// The URL that LcmBus opens for `url`, for programs that are told theirs.
std::string fullLcmUrl(std::string url);

// LCM with any provider URL; empty: $LCM_DEFAULT_URL, else LCM's default. A udpm URL without recv_buf_size
// gets one of 4 MB (the kernel grants twice net.core.rmem_max at most): LCM's default loses messages above
// 115 kB. Queues are unbounded, and large datagrams are sent with a short pause between them, so that a
// reader with the stock 208 KiB socket buffer keeps up with a burst of chunks.
class LcmBus : public Bus {
 public:
  // Throws Error, with what to do, if the URL is bad or the multicast self test fails.
  explicit LcmBus(const std::string& url);
  ~LcmBus() override;

  void publish(const std::string& channel, Bytes bytes) override;
  void subscribe(const std::string& channel, Handler handler) override;
  // Calls the handler for each message of every channel: for programs that watch.
  using AnyHandler = std::function<void(const std::string& channel, Bytes)>;
  void subscribeAll(AnyHandler handler);
  bool dispatch(int timeout_ms) override;

 private:
  struct Subscription;
  void add(const std::string& pattern, AnyHandler handler, const std::string& what);
  std::unique_ptr<lcm::LCM> lcm_;
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  std::exception_ptr pending_;  // what a handler threw while LCM's C code was on the stack
  size_t burst_bytes_ = 0;
};

}  // namespace sgraphs
