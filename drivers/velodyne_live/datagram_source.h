#pragma once

#include <cstdint>
#include <vector>

#include "common/types/udp_datagram.h"

namespace sgraphs {

// Where a driver's datagrams come from: the network, or a capture played as if live.
class DatagramSource {
 public:
  struct Health {
    int64_t dropped_by_kernel = 0;  // the socket's receive buffer was full
    int64_t dropped_by_queue = 0;   // the driver did not take them in time
    size_t waiting = 0;
  };

  virtual ~DatagramSource() = default;

  // Datagrams in order of arrival; waits up to timeout_ms for the first. Throws Error if the source failed.
  virtual std::vector<UdpDatagram> take(int timeout_ms) = 0;
  // Nothing will come any more.
  virtual bool ended() const = 0;
  // The clock that datagrams are stamped with.
  virtual Time now() const = 0;
  virtual Health health() const = 0;
};

}  // namespace sgraphs
