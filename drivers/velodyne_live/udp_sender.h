#pragma once

#include <cstdint>
#include <span>

namespace sgraphs {

// Sends datagrams to one host, as a sensor does.
class UdpSender {
 public:
  // address as LivePackets' parseAddress gives it. Throws Error if there is no socket to be had.
  explicit UdpSender(uint32_t address);
  ~UdpSender();
  UdpSender(const UdpSender&) = delete;
  UdpSender& operator=(const UdpSender&) = delete;

  // Throws Error if the network refuses it; that nobody listens is no error.
  void send(uint16_t port, std::span<const uint8_t> payload);

 private:
  uint32_t address_;
  int file_ = -1;
};

}  // namespace sgraphs
