#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "drivers/velodyne_live/datagram_source.h"

namespace sgraphs {

// Ports to listen on, and how.
struct UdpOptions {
  std::vector<uint16_t> ports;  // 0: a free one
  std::string bind_address;     // of an interface; empty: all
  std::string multicast_group;  // empty: none
  int receive_buffer_bytes = 4'000'000;
};

// Receives UDP datagrams, unicast, broadcast or of a group, on a thread of its own, stamped by the kernel
// where they arrived. The queue towards take() is bounded: what is too much is dropped and counted, the
// newest first.
class UdpReceiver : public DatagramSource {
 public:
  static constexpr size_t kMaxWaiting = 8192;  // 11 s of a VLP-16

  // Listens from now on. Throws Error, with what to do, if a port cannot be had.
  explicit UdpReceiver(const UdpOptions& options);
  ~UdpReceiver() override;
  UdpReceiver(const UdpReceiver&) = delete;
  UdpReceiver& operator=(const UdpReceiver&) = delete;

  std::vector<UdpDatagram> take(int timeout_ms) override;
  bool ended() const override { return false; }
  Time now() const override;
  Health health() const override;

  // Those in use, in the order asked for.
  const std::vector<uint16_t>& ports() const { return ports_; }
  // What the kernel gave each socket, in the measure of what was asked for.
  int grantedBuffer_bytes() const { return granted_bytes_; }

 private:
  struct Socket {
    int file = -1;
    uint16_t port = 0;
    uint32_t dropped = 0;  // as the kernel counts: wraps
  };
  void open(uint16_t port, const UdpOptions& options);
  void closeAll();
  void run();
  bool receive(Socket& socket);

  std::vector<Socket> sockets_;
  std::vector<uint16_t> ports_;
  int granted_bytes_ = 0;
  int stop_file_ = -1;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<UdpDatagram> waiting_;
  Health health_;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace sgraphs
