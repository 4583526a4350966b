#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/types/udp_datagram.h"

struct pcap;

namespace sgraphs {

// Frames of a capture by what became of them.
struct PcapCounts {
  int64_t frames = 0;
  int64_t udp = 0;
  int64_t fragments = 0;   // of IP datagrams; not put together again
  int64_t cut_frames = 0;  // the capture kept less than the whole frame
};

// UDP datagrams of a pcap or pcapng file in the order of the file: Ethernet (with 802.1Q and 802.1ad tags),
// Linux cooked and raw IP captures.
class PcapReader {
 public:
  // Throws Error if the file cannot be read, is empty, is no capture, or of a link type not listed above.
  explicit PcapReader(const std::string& path);
  ~PcapReader();

  std::optional<UdpDatagram> next();

  const PcapCounts& counts() const { return counts_; }
  // Empty; or what is wrong with the end of the file, whose whole frames were delivered.
  const std::string& damage() const { return damage_; }
  double progress() const;  // 0 to 1

 private:
  struct Closer {
    void operator()(pcap* handle) const;
  };
  std::optional<UdpDatagram> parse(const uint8_t* frame, size_t captured, size_t on_wire);

  std::string path_;
  std::unique_ptr<pcap, Closer> handle_;
  int link_type_ = 0;
  int64_t file_bytes_ = 0;
  PcapCounts counts_;
  std::string damage_;
};

}  // namespace sgraphs
