#include "drivers/velodyne_live/velodyne_driver_loop.h"

#include <spdlog/spdlog.h>

#include <memory>

#include "common/base/notify_ready.h"
#include "common/bus/journal_bus.h"
#include "common/bus/lcm_bus.h"
#include "drivers/host_clock.h"
#include "drivers/session_source.h"
#include "drivers/velodyne_live/pcap_player.h"
#include "drivers/velodyne_live/udp_receiver.h"
#include "drivers/velodyne_live/velodyne_driver_node.h"
#include "tools/system/stop_signals.h"

namespace sgraphs {
namespace {

constexpr int kPoll_ms = 50;

// The source, and the ports its datagrams carry.
struct Input {
  std::unique_ptr<DatagramSource> source;
  uint16_t data_port, position_port;
};

Input listen(const VelodyneDriverConfig& config) {
  UdpOptions options;
  options.ports = {static_cast<uint16_t>(config.data_port), static_cast<uint16_t>(config.position_port)};
  options.bind_address = config.bind_address;
  options.multicast_group = config.multicast_group;
  options.receive_buffer_bytes = config.receive_buffer_bytes;
  auto receiver = std::make_unique<UdpReceiver>(options);
  if (receiver->grantedBuffer_bytes() < config.receive_buffer_bytes)
    spdlog::warn(
        "asked for a receive buffer of {} bytes, the kernel gave {} ({:.2f} s of a VLP-16): "
        "sysctl -w net.core.rmem_max={}",
        config.receive_buffer_bytes, receiver->grantedBuffer_bytes(), receiver->grantedBuffer_bytes() / 1.0e6,
        config.receive_buffer_bytes);
  const std::vector<uint16_t> ports = receiver->ports();
  spdlog::info("UDP ports {} (data) and {} (position)", ports[0], ports[1]);
  return {std::move(receiver), ports[0], ports[1]};
}

Input openInput(const VelodyneDriverConfig& config, const VelodyneDriverOptions& options) {
  if (options.pcap.empty()) return listen(config);
  std::optional<Time> begin;
  if (options.epoch == "now") begin = hostClock();
  return {std::make_unique<PcapPlayer>(options.pcap, options.rate, begin),
          static_cast<uint16_t>(config.data_port), static_cast<uint16_t>(config.position_port)};
}

void say(VelodyneDriverNode& node) {
  for (const std::string& line : node.takeNotices()) spdlog::warn(line);
}

void report(const VelodyneDriverNode& node) {
  const PacketCounts& counts = node.packets().counts();
  int64_t refused = counts.other_sensor;
  for (const int64_t count : counts.rejected) refused += count;
  spdlog::info("{} packets, {} lost, {} refused, {} position packets", counts.accepted, counts.lost, refused,
               counts.position);
}

}  // namespace

int runVelodyneDriver(const ProcessText& text, const ProcessSetup& setup,
                      const VelodyneDriverOptions& options) {
  const DriverConfig& config = setup.config.drivers;
  LcmBus lcm(setup.lcm_url);
  JournalBus bus(lcm, "", setup.boot);  // numbers begin again: there is nothing to resume
  Input input = openInput(config.velodyne_driver, options);
  DatagramSource& source = *input.source;
  std::optional<Session> session;
  if (!options.no_session) {
    session =
        liveSession(config.session, text.name + " " SGRAPHS_VERSION, digestOf(setup.config), source.now());
    // Ids are of the instant of starting, also where an old capture's clock is kept.
    session->id = hostClock().us;
  }
  VelodyneDriverNode node(bus, LivePackets(config.velodyne_driver, input.data_port, input.position_port),
                          config.velodyne_driver, session);
  StopSignals signals;
  Stopwatch second, since_start;
  spdlog::info("listening");
  notifyReady();
  while (!source.ended() && !signals.requested()) {
    for (const UdpDatagram& datagram : source.take(kPoll_ms)) node.take(datagram);
    if (options.no_session)
      while (bus.dispatch(0)) {
      }
    say(node);
    if (options.end_after_s > 0 && since_start.elapsedSeconds() > options.end_after_s) break;
    if (second.elapsedSeconds() < 1.0) continue;
    node.everySecond(second.elapsedSeconds(), source.now(), source.health());
    second.restart();
  }
  node.finish(options.stream_end || !(options.no_stream_end || options.no_session), "");
  node.everySecond(second.elapsedSeconds(), source.now(), source.health());
  say(node);
  report(node);
  return leaveAfterEnd(
      text, [&node] { node.repeatEnd(); }, "");
}

}  // namespace sgraphs
