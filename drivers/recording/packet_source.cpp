#include "drivers/recording/packet_source.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "common/base/error.h"
#include "drivers/velodyne/position_packet.h"

namespace sgraphs {

std::optional<VelodynePacket> PacketSource::accept(std::span<const uint8_t> payload,
                                                   std::optional<Time> arrived,
                                                   std::optional<Time> first_firing) {
  Vlp16Packet packet;
  PacketFault fault = parsePacket(payload, packet);
  PacketMonitor::Verdict verdict;
  Time time;
  if (fault == PacketFault::kNone) {
    // A packet leaves the sensor at its last firing.
    if (arrived) first_firing = *arrived - Duration{std::llround(packet.lastFiring_us())};
    time = resolver_.resolve(packet.stamp_us, first_firing);
    verdict = monitor_.step(time, packet);
    fault = verdict.fault;
  }
  if (fault == PacketFault::kThirtyTwoBeams)
    throw Error("'" + path_ +
                "' is of a 32-beam sensor (its packets follow each other faster than a VLP-16's " +
                "1327 or 664 us): only VLP-16 packets can be converted");
  if (fault != PacketFault::kNone) {
    counts_.reject(fault);
    return std::nullopt;
  }
  counts_.accept(packet, monitor_.lost());
  VelodynePacket out;
  out.time = time;
  std::copy(payload.begin(), payload.end(), out.bytes.begin());
  return out;
}

std::vector<std::string> PacketSource::warnings() const {
  std::vector<std::string> lines;
  const auto warn = [&](int64_t count, const std::string& text) {
    if (count > 0) lines.push_back(path_ + ": " + std::to_string(count) + " " + text);
  };
  for (int fault = 1; fault < kNumPacketFaults; ++fault)
    warn(counts_.rejected[static_cast<size_t>(fault)],
         std::string("packet(s) refused: ") + toString(static_cast<PacketFault>(fault)));
  warn(counts_.other_sensor, "packet(s) left out: they come from a second sensor's address");
  warn(counts_.lost, "packet(s) lost before they were recorded, by the sensor's stamps");
  warn(counts_.repaired_azimuths, "azimuth(s) of 360 degrees or more, interpolated from their neighbours");
  warn(counts_.undefined_factory_bytes, "packet(s) of old firmware: the return mode is told by the azimuths");
  warn(resolver_.clockJumps(), "restart(s) of the sensor's clock");
  return lines;
}

PcapPacketSource::PcapPacketSource(const std::string& path, uint16_t data_port)
    : PacketSource(path, StampResolver::Clock::kAuto), reader_(path), data_port_(data_port) {}

std::optional<VelodynePacket> PcapPacketSource::next() {
  while (const std::optional<UdpDatagram> datagram = reader_.next()) {
    if (datagram->destination_port == data_port_) {
      const bool data_sized = datagram->payload.size() == kVlp16PacketBytes;
      if (data_sized && !sensor_address_) sensor_address_ = datagram->source_address;
      if (data_sized && datagram->source_address != *sensor_address_) {
        ++counts_.other_sensor;
        continue;
      }
      if (auto packet = accept(datagram->payload, datagram->captured, std::nullopt)) return packet;
    } else if (datagram->destination_port == kPositionPort &&
               datagram->payload.size() == kPositionPacketBytes) {
      ++counts_.position;
    } else {
      ++counts_.other_datagrams;
      data_sized_on_port_[datagram->destination_port] += datagram->payload.size() == kVlp16PacketBytes;
    }
  }
  return std::nullopt;
}

std::vector<std::string> PcapPacketSource::warnings() const {
  std::vector<std::string> lines = PacketSource::warnings();
  if (!reader_.damage().empty())
    lines.push_back(path_ + ": the capture is truncated (" + reader_.damage() +
                    "); what is whole was converted");
  if (reader_.counts().cut_frames > 0)
    lines.push_back(path_ + ": " + std::to_string(reader_.counts().cut_frames) +
                    " frame(s) were captured in part only: capture with the full snap length");
  if (reader_.counts().fragments > 0)
    lines.push_back(path_ + ": " + std::to_string(reader_.counts().fragments) +
                    " IP fragment(s) left out: capture on the sensor's own network");
  return lines;
}

std::string PcapPacketSource::whyNothing() const {
  const PcapCounts& frames = reader_.counts();
  std::string text = "'" + path_ + "' holds no VLP-16 data packet on UDP port " + std::to_string(data_port_) +
                     " (" + std::to_string(frames.frames) + " frames, " + std::to_string(frames.udp) + " UDP";
  if (frames.cut_frames > 0) text += ", " + std::to_string(frames.cut_frames) + " captured in part";
  if (!reader_.damage().empty()) text += "; " + reader_.damage();
  text += ")";
  for (const auto& [port, count] : data_sized_on_port_)
    if (count > 0)
      return text + ": port " + std::to_string(port) + " carries packets of that size, try --port " +
             std::to_string(port);
  const auto most = std::max_element(counts_.rejected.begin(), counts_.rejected.end());
  if (*most > 0)
    return text + ": " + std::to_string(*most) + " packets refused as '" +
           toString(static_cast<PacketFault>(most - counts_.rejected.begin())) + "'";
  return text + ": is it a recording of the LiDAR?";
}

RawPacketSource::RawPacketSource(const std::string& path, Time start)
    : PacketSource(path, StampResolver::Clock::kCarried), start_(start) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error("cannot read raw stream '" + path + "': check the path and its permissions");
  bytes_.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  if (bytes_.empty()) throw Error("raw stream '" + path + "' is empty: record or copy it again");
  if (bytes_.size() % kVlp16PacketBytes != 0)
    throw Error(
        "raw stream '" + path + "' has " + std::to_string(bytes_.size()) +
        " bytes, no multiple of 1206: give the packets' payloads back to back, or --pcap for a capture");
}

std::optional<VelodynePacket> RawPacketSource::next() {
  while (at_ < bytes_.size()) {
    const std::span<const uint8_t> payload(&bytes_[at_], kVlp16PacketBytes);
    at_ += kVlp16PacketBytes;
    if (auto packet =
            accept(payload, std::nullopt, counts_.accepted == 0 ? std::optional(start_) : std::nullopt))
      return packet;
  }
  return std::nullopt;
}

double RawPacketSource::progress() const {
  return static_cast<double>(at_) / static_cast<double>(bytes_.size());
}

std::string RawPacketSource::whyNothing() const {
  const auto most = std::max_element(counts_.rejected.begin(), counts_.rejected.end());
  return "'" + path_ + "' holds no VLP-16 data packet: " + std::to_string(*most) + " of " +
         std::to_string(bytes_.size() / kVlp16PacketBytes) + " refused as '" +
         toString(static_cast<PacketFault>(most - counts_.rejected.begin())) + "'";
}

}  // namespace sgraphs
