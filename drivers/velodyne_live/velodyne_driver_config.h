#pragma once

#include <string>

#include "common/config/config_io.h"

namespace sgraphs {

// The live VLP-16.
struct VelodyneDriverConfig {
  int data_port = 2368;
  int position_port = 8308;
  std::string bind_address;
  std::string multicast_group;
  std::string source_address;
  int receive_buffer_bytes = 4'000'000;
  std::string stamps = "auto";
  double cut_azimuth_deg = 0;
  double silence_s = 1;

  void visit(ConfigVisitor& v) {
    v.field("data_port", data_port, 0, 65535, "UDP port of the data packets; 0: a free one");
    v.field("position_port", position_port, 0, 65535, "UDP port of the position packets; 0: a free one");
    v.field("bind_address", bind_address, {}, "Address of the interface to listen on; empty: all");
    v.field("multicast_group", multicast_group, {},
            "Group to join for a sensor that sends to one; empty: none");
    v.field("source_address", source_address, {},
            "Take packets of this sensor only; empty: of the first one heard");
    v.field("receive_buffer_bytes", receive_buffer_bytes, 65536, 1'000'000'000,
            "Receive buffer to ask the kernel for; a second of a VLP-16 is 1 MB");
    v.field(
        "stamps", stamps, {"auto", "host", "device"},
        "Time of a packet: the sensor's clock carried onto the host's, arrival, or the sensor's own (GPS)");
    v.field("cut_azimuth_deg", cut_azimuth_deg, 0, 359.99,
            "Where revolutions are cut, clockwise from the sensor's y axis");
    v.field("silence_s", silence_s, 0.1, 60, "No packet for this long is called silence");
  }
};

}  // namespace sgraphs
