#pragma once

#include <string>
#include <vector>

#include "common/bus/channels.h"
#include "common/bus/memory_bus.h"
#include "common/types/session.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs::testing {

// Every decoded message of a channel, in order.
template <typename Message>
class Recorder {
 public:
  Recorder(Bus& bus, const Channel<Message>& channel) {
    subscribe(
        bus, channel, [this](const Message& m) { messages.push_back(m); }, [this] { ++undecodable; });
  }
  std::vector<Message> messages;
  int undecodable = 0;
};

// The source of a stream: numbers its messages, can leave some out, delivers at once.
class Source {
 public:
  static constexpr int64_t kStart_us = 1'700'000'000'000'000;

  explicit Source(MemoryBus& bus, int64_t session = 7) : bus_(bus), session_(session) {}

  void session(const std::string& mode, bool has_odometry, std::vector<std::string> stages = {}) {
    Session s;
    s.id = session_;
    s.odometry_mode = mode;
    s.has_odometry = has_odometry;
    s.stages = std::move(stages);
    send(channels::kSession, toMessage(s, Time{kStart_us}));
  }
  // One packet at this time after the start: with the fake decoder one scan, 0.1 s long.
  void packet(double at_s) {
    VelodynePacket packet;
    packet.time = at(at_s);
    send(channels::kVelodynePackets, toMessage({&packet, 1}, revolution_++, 0, true));
  }
  void odometry(double at_s) { send(channels::kSpotOdometry, toMessage(BodyOdometry{at(at_s), SE3()})); }
  void end(const std::string& why_not = "") {
    stream_end_t m{};
    m.why_not = why_not;
    for (const char* channel : {"SESSION", "VELODYNE_PACKETS", "SPOT_ODOMETRY"}) {
      m.channel.push_back(channel);
      m.last_seq.push_back(next_seq_[channel] - 1);
    }
    m.num_channels = 3;
    send(channels::kStreamEnd, m);
  }
  // The next message of this channel gets its number but is not sent.
  void loseNext(const std::string& channel) { lose_ = channel; }

  template <typename Message>
  void send(const Channel<Message>& channel, Message m) {
    m.header.session = session_;
    m.header.seq = next_seq_[channel.name]++;
    if (lose_ == channel.name) {
      lose_.clear();
      return;
    }
    publish(bus_, channel, m);
    bus_.dispatch(0);
  }
  static Time at(double s) { return Time{kStart_us} + Duration::fromSeconds(s); }

 private:
  MemoryBus& bus_;
  int64_t session_;
  int64_t revolution_ = 0;
  std::map<std::string, int64_t> next_seq_;
  std::string lose_;
};

}  // namespace sgraphs::testing
