#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/recording/pcap_reader.h"
#include "drivers/velodyne/packet_counts.h"
#include "drivers/velodyne/packet_monitor.h"
#include "drivers/velodyne/stamp_resolver.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs {

// The packets of one recorded VLP-16, checked, with their instants. Refused packets are left out and counted.
class PacketSource {
 public:
  PacketSource(std::string path, StampResolver::Clock clock) : path_(std::move(path)), resolver_(clock) {}
  virtual ~PacketSource() = default;

  // Next accepted packet; nothing at the end. Throws Error if this is a 32-beam sensor.
  virtual std::optional<VelodynePacket> next() = 0;
  virtual double progress() const = 0;  // 0 to 1
  // One line each, of what the user ought to know once the end is reached.
  virtual std::vector<std::string> warnings() const;
  // What the recording held instead, for the error that nothing came out of it.
  virtual std::string whyNothing() const = 0;

  const PacketCounts& counts() const { return counts_; }

 protected:
  // arrived: by the host's clock; without one, the first firing of the first packet is given once.
  std::optional<VelodynePacket> accept(std::span<const uint8_t> payload, std::optional<Time> arrived,
                                       std::optional<Time> first_firing);

  std::string path_;
  StampResolver resolver_;
  PacketMonitor monitor_;
  PacketCounts counts_;
};

class PcapPacketSource : public PacketSource {
 public:
  static constexpr uint16_t kDataPort = 2368, kPositionPort = 8308;
  explicit PcapPacketSource(const std::string& path, uint16_t data_port = kDataPort);
  std::optional<VelodynePacket> next() override;
  double progress() const override { return reader_.progress(); }
  std::vector<std::string> warnings() const override;
  std::string whyNothing() const override;

 private:
  PcapReader reader_;
  uint16_t data_port_;
  std::optional<uint32_t> sensor_address_;
  std::map<uint16_t, int64_t> data_sized_on_port_;  // 1206-byte datagrams to other ports
};

// 1206-byte packets back to back, without any framing.
class RawPacketSource : public PacketSource {
 public:
  // Throws Error if the file is unreadable, empty, or no multiple of 1206 bytes.
  RawPacketSource(const std::string& path, Time start);
  std::optional<VelodynePacket> next() override;
  double progress() const override;
  std::string whyNothing() const override;

 private:
  std::vector<uint8_t> bytes_;
  size_t at_ = 0;
  Time start_;
};

}  // namespace sgraphs
