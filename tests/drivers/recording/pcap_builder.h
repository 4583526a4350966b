#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sgraphs::test {

// Builds a classic pcap file frame by frame.
class PcapBuilder {
 public:
  explicit PcapBuilder(uint32_t link_type = 1) {
    put32(0xA1B2C3D4);
    put16(2);
    put16(4);
    put32(0);
    put32(0);
    put32(65535);
    put32(link_type);
  }

  struct Frame {
    int64_t time_us = 0;
    uint16_t port = 2368;
    uint8_t source = 201;  // last byte of 192.168.1.x
    int vlan_tags = 0;
    uint16_t fragment = 0;
    uint8_t protocol = 17;
    size_t snap = 65535;
  };

  void addUdp(const Frame& f, std::span<const uint8_t> payload) {
    std::vector<uint8_t> frame(12, 0x11);
    for (int tag = 0; tag < f.vlan_tags; ++tag) append(frame, {0x81, 0x00, 0x00, 0x2A});
    append(frame, {0x08, 0x00});
    const size_t udp_bytes = 8 + payload.size(), ip_bytes = 20 + udp_bytes;
    append(frame, {0x45,
                   0,
                   hi(ip_bytes),
                   lo(ip_bytes),
                   0,
                   0,
                   hi(f.fragment),
                   lo(f.fragment),
                   64,
                   f.protocol,
                   0,
                   0,
                   192,
                   168,
                   1,
                   f.source,
                   255,
                   255,
                   255,
                   255});
    append(frame, {hi(f.port), lo(f.port), hi(f.port), lo(f.port), hi(udp_bytes), lo(udp_bytes), 0, 0});
    frame.insert(frame.end(), payload.begin(), payload.end());
    addFrame(f.time_us, frame, f.snap);
  }

  void addFrame(int64_t time_us, const std::vector<uint8_t>& frame, size_t snap = 65535) {
    put32(static_cast<uint32_t>(time_us / 1'000'000));
    put32(static_cast<uint32_t>(time_us % 1'000'000));
    const size_t kept = std::min(snap, frame.size());
    put32(static_cast<uint32_t>(kept));
    put32(static_cast<uint32_t>(frame.size()));
    bytes_.insert(bytes_.end(), frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(kept));
  }

  const std::vector<uint8_t>& bytes() const { return bytes_; }

 private:
  static uint8_t hi(size_t v) { return static_cast<uint8_t>(v >> 8); }
  static uint8_t lo(size_t v) { return static_cast<uint8_t>(v); }
  static void append(std::vector<uint8_t>& out, std::initializer_list<uint8_t> bytes) {
    out.insert(out.end(), bytes);
  }
  void put16(uint16_t v) { append(bytes_, {lo(v), hi(v)}); }
  void put32(uint32_t v) {
    put16(static_cast<uint16_t>(v));
    put16(static_cast<uint16_t>(v >> 16));
  }
  std::vector<uint8_t> bytes_;
};

}  // namespace sgraphs::test
