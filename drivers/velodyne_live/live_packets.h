#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/types/udp_datagram.h"
#include "drivers/driver_config.h"
#include "drivers/velodyne/packet_clock.h"
#include "drivers/velodyne/packet_counts.h"
#include "drivers/velodyne/packet_grouper.h"
#include "drivers/velodyne/packet_monitor.h"
#include "drivers/velodyne/position_packet.h"
#include "drivers/velodyne_live/notices.h"

namespace sgraphs {

// Address as in 192.168.1.201 to a number; throws UsageError, naming the option, for another text.
uint32_t parseAddress(const std::string& text, const std::string& option);
std::string toString(uint32_t address);

// Datagrams of a live VLP-16 in, groups of checked and stamped packets out: a pure function of the datagrams
// and their times of arrival.
//
// The first source of a data packet is the sensor; others are refused and named, until the sensor has been
// silent for 10 s: then the next source is taken, as for a sensor that was replaced.
class LivePackets {
 public:
  // data_port, position_port: those the datagrams carry. Throws UsageError for a setting that is none.
  LivePackets(const VelodyneDriverConfig& config, uint16_t data_port, uint16_t position_port);

  std::optional<PacketGroup> step(const UdpDatagram& datagram);
  // What waits for the rest of its group.
  std::optional<PacketGroup> flush() { return grouper_.flush(); }

  const PacketCounts& counts() const { return counts_; }
  // The newest position packet.
  const std::optional<PositionPacket>& position() const { return position_; }
  int64_t clockJumps() const { return clock_.sensorJumps() + clock_.hostJumps(); }
  bool thirtyTwoBeams() const { return monitor_.thirtyTwoBeams(); }
  // Lines for people since the last call.
  std::vector<std::string> takeNotices() { return notices_.take(); }

 private:
  bool fromOurSensor(const UdpDatagram& datagram);
  std::optional<PacketGroup> takeData(const UdpDatagram& datagram);
  void takePosition(const UdpDatagram& datagram);
  void refuse(const UdpDatagram& datagram, PacketFault fault);
  void noteClock();

  VelodyneDriverConfig config_;
  uint16_t data_port_, position_port_;
  std::optional<uint32_t> only_source_, sensor_;
  Time last_accepted_;  // by the host's clock
  PacketClock clock_;
  PacketMonitor monitor_;
  PacketGrouper grouper_;
  PacketCounts counts_;
  std::optional<PositionPacket> position_;
  Notices notices_;
  int64_t lost_before_ = 0;  // packets of sensors before this one
  int64_t noted_sensor_jumps_ = 0, noted_host_jumps_ = 0;
};

}  // namespace sgraphs
