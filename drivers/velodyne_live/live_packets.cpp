#include "drivers/velodyne_live/live_packets.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.h"

namespace sgraphs {
namespace {

constexpr Duration kForgetSensor{10'000'000};

PacketClock::Mode clockMode(const std::string& stamps) {
  if (stamps == "host") return PacketClock::Mode::kHost;
  if (stamps == "device") return PacketClock::Mode::kDevice;
  return PacketClock::Mode::kAuto;
}

}  // namespace

uint32_t parseAddress(const std::string& text, const std::string& option) {
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1)
    throw UsageError(option + " '" + text + "': give an IPv4 address like 192.168.1.201");
  return ntohl(address.s_addr);
}

std::string toString(uint32_t address) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8)
    text += (text.empty() ? "" : ".") + std::to_string(address >> shift & 0xFF);
  return text;
}

LivePackets::LivePackets(const VelodyneDriverConfig& config, uint16_t data_port, uint16_t position_port)
    : config_(config),
      data_port_(data_port),
      position_port_(position_port),
      clock_(clockMode(config.stamps)),
      grouper_(config.cut_azimuth_deg) {
  if (!config.source_address.empty())
    only_source_ = parseAddress(config.source_address, "drivers.velodyne_driver.source_address");
}

std::optional<PacketGroup> LivePackets::step(const UdpDatagram& datagram) {
  if (datagram.destination_port == data_port_) return takeData(datagram);
  if (datagram.destination_port == position_port_) {
    takePosition(datagram);
    return std::nullopt;
  }
  ++counts_.other_datagrams;
  return std::nullopt;
}

bool LivePackets::fromOurSensor(const UdpDatagram& datagram) {
  if (only_source_) return datagram.source_address == *only_source_;
  return !sensor_ || datagram.source_address == *sensor_ ||
         datagram.captured - last_accepted_ > kForgetSensor;
}

std::optional<PacketGroup> LivePackets::takeData(const UdpDatagram& datagram) {
  if (!fromOurSensor(datagram)) {
    ++counts_.other_sensor;
    const std::string source = toString(datagram.source_address);
    notices_.add("source " + source, "packets from " + source + " on port " + std::to_string(data_port_) +
                                         " are left out: the sensor is " +
                                         toString(only_source_ ? *only_source_ : *sensor_));
    return std::nullopt;
  }
  Vlp16Packet packet;
  const PacketFault unfit = parsePacket(datagram.payload, packet);
  if (unfit != PacketFault::kNone) {
    refuse(datagram, unfit);
    return std::nullopt;
  }
  if (!sensor_ || datagram.captured - last_accepted_ > kForgetSensor) {
    // A sensor, or one that was restarted or replaced; time goes on from what was published.
    if (sensor_) lost_before_ += monitor_.lost();
    monitor_ = PacketMonitor();
    sensor_ = datagram.source_address;
    last_accepted_ = datagram.captured;
  }
  // A packet leaves the sensor when its last sequence is over.
  const Time host = datagram.captured - Duration{std::llround(packet.period_us())};
  const PacketClock::Stamp stamp = clock_.step(packet.stamp_us, host);
  noteClock();
  if (stamp.stray) {
    refuse(datagram, PacketFault::kStrayStamp);
    return std::nullopt;
  }
  const PacketMonitor::Verdict verdict = monitor_.step(stamp.sensor, packet);
  if (verdict.fault != PacketFault::kNone || !stamp.published) {
    refuse(datagram, verdict.fault == PacketFault::kNone ? PacketFault::kOutOfOrder : verdict.fault);
    return std::nullopt;
  }
  last_accepted_ = datagram.captured;
  counts_.accept(packet, lost_before_ + monitor_.lost());
  VelodynePacket out{*stamp.published, {}};
  std::copy(datagram.payload.begin(), datagram.payload.end(), out.bytes.begin());
  return grouper_.step(out);
}

void LivePackets::takePosition(const UdpDatagram& datagram) {
  const bool ours = only_source_ ? datagram.source_address == *only_source_
                                 : !sensor_ || datagram.source_address == *sensor_;
  if (!ours) {
    ++counts_.other_sensor;
    return;
  }
  const std::optional<PositionPacket> packet = parsePositionPacket(datagram.payload);
  if (!packet) {
    ++counts_.other_datagrams;
    notices_.add("position", "datagrams on port " + std::to_string(position_port_) +
                                 " that are no position packets are left out");
    return;
  }
  ++counts_.position;
  position_ = packet;
}

void LivePackets::refuse(const UdpDatagram& datagram, PacketFault fault) {
  counts_.reject(fault);
  std::string text =
      std::string("a packet from ") + toString(datagram.source_address) + " is refused: " + toString(fault);
  if (fault == PacketFault::kWrongSize) text += " but " + std::to_string(datagram.payload.size());
  if (fault == PacketFault::kThirtyTwoBeams)
    text =
        toString(datagram.source_address) +
        " is a 32-beam sensor (HDL-32E or VLP-32C, by the rhythm of its packets): only VLP-16s are read, " +
        "all its packets are refused";
  notices_.add(toString(fault), text);
}

void LivePackets::noteClock() {
  if (clock_.sensorJumps() > noted_sensor_jumps_)
    notices_.add("sensor clock",
                 "the sensor's clock was set anew (restart, or GPS found): its stamps are "
                 "carried on without a step back");
  if (clock_.hostJumps() > noted_host_jumps_)
    notices_.add("host clock", "the host's clock was set by more than a second: a step back is not followed");
  noted_sensor_jumps_ = clock_.sensorJumps();
  noted_host_jumps_ = clock_.hostJumps();
}

}  // namespace sgraphs
