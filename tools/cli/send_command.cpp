#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>

#include "common/base/error.h"
#include "common/base/performance.h"
#include "common/bus/channels.h"
#include "common/bus/log_file.h"
#include "drivers/recording/pcap_reader.h"
#include "drivers/velodyne/vlp16_packet.h"
#include "drivers/velodyne_live/live_packets.h"
#include "drivers/velodyne_live/udp_sender.h"
#include "lcmtypes/convert/convert.h"
#include "tools/cli/commands.h"
#include "tools/simulate/sensor/fault_injector.h"
#include "tools/simulate/sensor/random_stream.h"

namespace sgraphs::cli {
namespace {

constexpr uint16_t kDataPort = 2368, kPositionPort = 8308;
constexpr uint64_t kGarbageStream = 0x67617262;  // apart from the streams of the other faults
constexpr size_t kMostGarbageBytes = 1500;

struct SendArguments {
  std::string file, to = "127.0.0.1:2368";
  uint16_t position_port = kPositionPort;
  double rate = 1;
  uint64_t seed = 1;
  simulate::FaultModel faults;
  double garbage = 0;
};

// Datagrams as a sensor sent them, from a capture or from the VELODYNE_PACKETS of a log.
class RecordedDatagrams {
 public:
  explicit RecordedDatagrams(const std::string& path) {
    try {
      pcap_ = std::make_unique<PcapReader>(path);
    } catch (const Error& no_capture) {
      try {
        log_ = std::make_unique<LogReader>(path);
      } catch (const Error&) {
        throw no_capture;
      }
    }
  }
  std::optional<UdpDatagram> next() {
    if (pcap_) return pcap_->next();
    while (waiting_.empty()) {
      const std::optional<LogEvent> event = log_->next();
      if (!event) return std::nullopt;
      velodyne_packets_t message{};
      if (event->channel != channels::kVelodynePackets.name || !decode(event->bytes, message)) continue;
      waiting_ = fromMessage(message).value_or(std::vector<VelodynePacket>{});
      std::reverse(waiting_.begin(), waiting_.end());
    }
    const VelodynePacket packet = waiting_.back();
    waiting_.pop_back();
    return UdpDatagram{packet.time, 0, kDataPort, {packet.bytes.begin(), packet.bytes.end()}};
  }

 private:
  std::unique_ptr<PcapReader> pcap_;
  std::unique_ptr<LogReader> log_;
  std::vector<VelodynePacket> waiting_;  // the next one last
};

// Data packets through the faults, and out.
class FaultySensor {
 public:
  FaultySensor(const SendArguments& arguments, UdpSender& sender, uint16_t data_port, Time start)
      : sender_(sender),
        data_port_(data_port),
        faults_(arguments.faults, arguments.seed, start),
        garbage_(arguments.garbage),
        random_(arguments.seed, kGarbageStream) {}

  void send(const UdpDatagram& datagram) {
    simulate::SensorPacket packet{datagram.captured, {}};
    std::copy(datagram.payload.begin(), datagram.payload.end(), packet.bytes.begin());
    sendAll(faults_.step(packet));
    if (garbage_ > 0 && random_.uniform() < garbage_) sendGarbage();
  }
  void finish() { sendAll(faults_.finish()); }

  int64_t sent() const { return sent_; }
  int64_t garbage() const { return garbage_sent_; }
  const simulate::FaultCounts& counts() const { return faults_.counts(); }

 private:
  void sendAll(const std::vector<simulate::SensorPacket>& packets) {
    for (const simulate::SensorPacket& packet : packets) sender_.send(data_port_, packet.bytes);
    sent_ += static_cast<int64_t>(packets.size());
  }
  void sendGarbage() {
    std::vector<uint8_t> bytes(static_cast<size_t>(random_.uniform() * kMostGarbageBytes));
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random_.uniform() * 256);
    sender_.send(data_port_, bytes);
    ++garbage_sent_;
  }

  UdpSender& sender_;
  uint16_t data_port_;
  simulate::FaultInjector faults_;
  double garbage_;
  simulate::RandomStream random_;
  int64_t sent_ = 0, garbage_sent_ = 0;
};

void waitUntil(const Stopwatch& watch, double due_s) {
  const double wait_s = due_s - watch.elapsedSeconds();
  if (wait_s > 0) std::this_thread::sleep_for(std::chrono::duration<double>(wait_s));
}

std::pair<uint32_t, uint16_t> parseTarget(const std::string& to) {
  const size_t colon = to.find(':');
  const int port = colon == std::string::npos ? kDataPort : std::atoi(to.c_str() + colon + 1);
  if (port < 1 || port > 65535) throw UsageError("--to '" + to + "': give address:port, 127.0.0.1:2368");
  return {parseAddress(to.substr(0, colon), "--to"), static_cast<uint16_t>(port)};
}

void runSendCommand(const SendArguments& arguments) {
  const auto [address, port] = parseTarget(arguments.to);
  RecordedDatagrams datagrams(arguments.file);
  std::optional<UdpDatagram> next = datagrams.next();
  if (!next) throw Error("'" + arguments.file + "' holds neither UDP datagrams nor VELODYNE_PACKETS");
  UdpSender sender(address);
  const Time start = next->captured;
  FaultySensor sensor(arguments, sender, port, start);
  const Stopwatch watch;
  int64_t position = 0;
  for (; next; next = datagrams.next()) {
    if (arguments.rate > 0) waitUntil(watch, (next->captured - start).seconds() / arguments.rate);
    if (next->destination_port == kDataPort && next->payload.size() == kVlp16PacketBytes) {
      sensor.send(*next);
    } else if (next->destination_port == kPositionPort) {
      sender.send(arguments.position_port, next->payload);
      ++position;
    }
  }
  sensor.finish();
  const simulate::FaultCounts& counts = sensor.counts();
  std::printf(
      "%s: %lld data packets and %lld position packets sent in %.1f s; %lld lost, %lld duplicated, %lld "
      "pairs "
      "reordered, %lld corrupted, %lld datagrams of garbage\n",
      arguments.to.c_str(), static_cast<long long>(sensor.sent()), static_cast<long long>(position),
      watch.elapsedSeconds(), static_cast<long long>(counts.lost), static_cast<long long>(counts.duplicated),
      static_cast<long long>(counts.reordered), static_cast<long long>(counts.corrupted),
      static_cast<long long>(sensor.garbage()));
}

}  // namespace

void addSend(CLI::App& app) {
  auto arguments = std::make_shared<SendArguments>();
  CLI::App* command =
      app.add_subcommand("send-packets", "Send a recorded VLP-16's packets by UDP, as the sensor would");
  command->footer(
      "Example:\n  sgraphs send-packets lidar.pcap --to 127.0.0.1:2368 --rate 1 --loss 0.01 --seed 7");
  command->add_option("file", arguments->file, "Capture (pcap), or log with VELODYNE_PACKETS")->required();
  command->add_option("--to", arguments->to, "Address and port of the data packets")->capture_default_str();
  command->add_option("--position-port", arguments->position_port, "Port of the position packets")
      ->capture_default_str();
  command->add_option("--rate", arguments->rate, "Speed, 1 as recorded; 0: as fast as possible")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "Of the faults")->capture_default_str();
  const CLI::Range share(0.0, 1.0);
  command->add_option("--loss", arguments->faults.packet_loss, "Share of packets lost")->check(share);
  command->add_option("--duplicates", arguments->faults.packet_duplicates, "Share sent twice")->check(share);
  command->add_option("--reorder", arguments->faults.packet_reorders, "Share overtaken by the next")
      ->check(share);
  command->add_option("--corrupt", arguments->faults.packet_corruption, "Share with noise in some bytes")
      ->check(share);
  command->add_option("--garbage", arguments->garbage, "Datagrams of noise, as a share of the packets")
      ->check(share);
  command->callback([arguments] { runSendCommand(*arguments); });
}

}  // namespace sgraphs::cli
