#include "common/bus/lcm_bus.h"

#include <chrono>
#include <lcm/lcm-cpp.hpp>
#include <thread>
#include <utility>

#include "common/base/error.h"

namespace sgraphs {
namespace {

// After this many bytes in one go the publisher yields for a moment; half of the stock socket buffer.
constexpr size_t kBurstBytes = size_t{96} * 1024;
constexpr auto kBurstPause = std::chrono::microseconds(1500);

// LCM takes a regular expression: every character that is not plain is escaped.
std::string literal(const std::string& channel) {
  std::string pattern;
  for (const char c : channel) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_') pattern += '\\';
    pattern += c;
  }
  return pattern;
}

}  // namespace

std::string fullLcmUrl(std::string url) {
  if (url.empty()) {
    const char* from_environment = std::getenv("LCM_DEFAULT_URL");
    url = from_environment && *from_environment ? from_environment : "udpm://239.255.76.67:7667?ttl=0";
  }
  if (url.rfind("udpm://", 0) == 0 && url.find("recv_buf_size") == std::string::npos)
    url += (url.find('?') == std::string::npos ? "?" : "&") + std::string("recv_buf_size=4000000");
  return url;
}

struct LcmBus::Subscription {
  LcmBus* bus;
  AnyHandler handler;

  void onMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    if (bus->pending_) return;
    try {
      handler(channel, {static_cast<const uint8_t*>(buffer->data), buffer->data_size});
    } catch (...) {
      bus->pending_ = std::current_exception();
    }
  }
};

LcmBus::LcmBus(const std::string& url) {
  const std::string full = fullLcmUrl(url);
  lcm_ = std::make_unique<lcm::LCM>(full);
  if (!lcm_->good())
    throw Error("cannot open the LCM bus '" + full + "': check the URL (udpm://239.255.76.67:7667?ttl=0, " +
                "tcpq://…, file://…) and the network");
}

LcmBus::~LcmBus() = default;

void LcmBus::publish(const std::string& channel, Bytes bytes) {
  burst_bytes_ += bytes.size();
  if (burst_bytes_ > kBurstBytes) {
    std::this_thread::sleep_for(kBurstPause);
    burst_bytes_ = bytes.size();
  }
  if (lcm_->publish(channel, bytes.data(), static_cast<unsigned int>(bytes.size())) != 0)
    throw Error(
        "cannot publish " + std::to_string(bytes.size()) + " bytes on " + channel +
        ": check the multicast route (`ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo`)");
}

void LcmBus::subscribe(const std::string& channel, Handler handler) {
  add(
      literal(channel), [handler = std::move(handler)](const std::string&, Bytes bytes) { handler(bytes); },
      channel);
}

void LcmBus::subscribeAll(AnyHandler handler) {
  add(".*", std::move(handler), "all channels");
}

void LcmBus::add(const std::string& pattern, AnyHandler handler, const std::string& what) {
  auto subscription = std::make_unique<Subscription>(Subscription{this, std::move(handler)});
  lcm::Subscription* handle = lcm_->subscribe(pattern, &Subscription::onMessage, subscription.get());
  if (!handle)
    throw Error("cannot subscribe to " + what + ": LCM's multicast self test failed; give this machine a " +
                "multicast route (`ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo`)");
  handle->setQueueCapacity(0);
  subscriptions_.push_back(std::move(subscription));
}

bool LcmBus::dispatch(int timeout_ms) {
  const int handled = lcm_->handleTimeout(timeout_ms);
  burst_bytes_ = 0;
  if (pending_) std::rethrow_exception(std::exchange(pending_, nullptr));
  if (handled < 0) throw Error("the LCM bus failed while waiting for messages");
  return handled > 0;
}

}  // namespace sgraphs
