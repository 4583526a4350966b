#pragma once

#include <cstdint>
#include <vector>

#include "common/base/time.h"

namespace sgraphs {

// One UDP datagram over IPv4.
struct UdpDatagram {
  Time captured;                // by the host's clock
  uint32_t source_address = 0;  // 192.168.1.201 is 0xC0A801C9
  uint16_t destination_port = 0;
  std::vector<uint8_t> payload;
};

}  // namespace sgraphs
