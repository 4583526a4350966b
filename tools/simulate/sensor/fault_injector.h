#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tools/simulate/sensor/fault_model.h"
#include "tools/simulate/sensor/sensor_simulator.h"

namespace sgraphs::simulate {

// What was done to the packets so far.
struct FaultCounts {
  int64_t lost = 0;
  int64_t silenced = 0;
  int64_t duplicated = 0;
  int64_t reordered = 0;  // pairs that changed places
  int64_t corrupted = 0;

  int64_t total() const { return lost + silenced + duplicated + reordered + corrupted; }
};

// The way from the sensor to the log, with its faults. A packet that arrives keeps the time at which the host
// saw its first firing; a clock jump changes only the stamp inside the packet. What befalls packet k depends
// on (model, seed, k) alone.
//
// Corruption overwrites 1 to 16 bytes anywhere in the packet with noise. Datagrams of a wrong length are no
// fault of their own: the log holds packets of 1206 bytes, and a receiver drops others, which is a loss.
class FaultInjector {
 public:
  // `start`: first firing of the recording, from which silences and clock jumps are counted.
  FaultInjector(FaultModel model, uint64_t seed, Time start);

  // The next packet of the sensor, in its order; returns what arrives now: none to three packets.
  std::vector<SensorPacket> step(const SensorPacket& packet);
  // What is still on its way at the end.
  std::vector<SensorPacket> finish();

  const FaultCounts& counts() const { return counts_; }

 private:
  bool silent(Time time) const;
  void jumpClock(SensorPacket& packet) const;

  FaultModel model_;
  uint64_t seed_;
  Time start_;
  uint64_t next_index_ = 0;
  std::vector<SensorPacket> held_;  // overtaken by the packet after it: with its duplicate, if it has one
  FaultCounts counts_;
};

}  // namespace sgraphs::simulate
