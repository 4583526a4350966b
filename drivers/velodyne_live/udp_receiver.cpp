#include "drivers/velodyne_live/udp_receiver.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <iterator>

#include "common/base/error.h"
#include "drivers/host_clock.h"

namespace sgraphs {
namespace {

constexpr size_t kMaxDatagramBytes = 2048;  // larger ones are cut, and refused by their size
constexpr int kMostOfOneSocket = 256;       // datagrams before the other's turn

[[noreturn]] void fail(const std::string& what, const std::string& what_to_do) {
  throw Error(what + ": " + std::strerror(errno) + (what_to_do.empty() ? "" : "; " + what_to_do));
}

in_addr addressOf(const std::string& text, const char* what) {
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1)
    throw UsageError(std::string(what) + " '" + text + "': give an IPv4 address");
  return address;
}

template <typename Value>
bool setOption(int file, int level, int option, const Value& value) {
  return setsockopt(file, level, option, &value, sizeof value) == 0;
}

}  // namespace

UdpReceiver::UdpReceiver(const UdpOptions& options) {
  try {
    for (const uint16_t port : options.ports) open(port, options);
    stop_file_ = eventfd(0, EFD_CLOEXEC);
    if (stop_file_ < 0) fail("cannot listen", "");
  } catch (...) {
    closeAll();
    throw;
  }
  thread_ = std::thread([this] { run(); });
}

UdpReceiver::~UdpReceiver() {
  const uint64_t one = 1;
  if (write(stop_file_, &one, sizeof one) == sizeof one) thread_.join();
  closeAll();
}

void UdpReceiver::closeAll() {
  for (const Socket& socket : sockets_) close(socket.file);
  if (stop_file_ >= 0) close(stop_file_);
}

void UdpReceiver::open(uint16_t port, const UdpOptions& options) {
  const std::string name = "UDP port " + std::to_string(port);
  const int file = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (file < 0) fail("cannot open " + name, "");
  sockets_.push_back({file, port});
  if (!setOption(file, SOL_SOCKET, SO_REUSEADDR, 1) || !setOption(file, SOL_SOCKET, SO_TIMESTAMPNS, 1) ||
      !setOption(file, SOL_SOCKET, SO_RXQ_OVFL, 1))
    fail("cannot set up " + name, "");
  setOption(file, SOL_SOCKET, SO_RCVBUF, options.receive_buffer_bytes);
  socklen_t size = sizeof granted_bytes_;
  getsockopt(file, SOL_SOCKET, SO_RCVBUF, &granted_bytes_, &size);
  granted_bytes_ /= 2;  // the kernel doubles what it grants, for its own bookkeeping
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_port = htons(port);
  // Bound to one interface's address a socket hears neither broadcasts nor groups; those come to any.
  if (!options.bind_address.empty() && options.multicast_group.empty())
    own.sin_addr = addressOf(options.bind_address, "drivers.velodyne_driver.bind_address");
  if (bind(file, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0)
    fail("cannot listen on " + name,
         "is another program using it (on Spot: `systemctl stop velodyne_service`), is the address right?");
  if (!options.multicast_group.empty()) {
    ip_mreq group{};
    group.imr_multiaddr = addressOf(options.multicast_group, "drivers.velodyne_driver.multicast_group");
    if (!options.bind_address.empty())
      group.imr_interface = addressOf(options.bind_address, "drivers.velodyne_driver.bind_address");
    if (!setOption(file, IPPROTO_IP, IP_ADD_MEMBERSHIP, group))
      fail("cannot join group " + options.multicast_group,
           "set drivers.velodyne_driver.bind_address to the interface's own address");
  }
  size = sizeof own;
  getsockname(file, reinterpret_cast<sockaddr*>(&own), &size);
  sockets_.back().port = ntohs(own.sin_port);
  ports_.push_back(sockets_.back().port);
}

Time UdpReceiver::now() const {
  return hostClock();
}

DatagramSource::Health UdpReceiver::health() const {
  const std::lock_guard lock(mutex_);
  Health health = health_;
  health.waiting = waiting_.size();
  return health;
}

std::vector<UdpDatagram> UdpReceiver::take(int timeout_ms) {
  std::unique_lock lock(mutex_);
  arrived_.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                    [this] { return !waiting_.empty() || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  std::vector<UdpDatagram> taken(std::make_move_iterator(waiting_.begin()),
                                 std::make_move_iterator(waiting_.end()));
  waiting_.clear();
  return taken;
}

void UdpReceiver::run() {
  try {
    std::vector<pollfd> files;
    for (const Socket& socket : sockets_) files.push_back({socket.file, POLLIN, 0});
    files.push_back({stop_file_, POLLIN, 0});
    while (true) {
      if (poll(files.data(), files.size(), -1) < 0 && errno != EINTR) fail("waiting for packets", "");
      if (files.back().revents != 0) return;
      for (Socket& socket : sockets_)
        for (int i = 0; i < kMostOfOneSocket && receive(socket); ++i) {
        }
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    arrived_.notify_all();
  }
}

bool UdpReceiver::receive(Socket& socket) {
  std::array<uint8_t, kMaxDatagramBytes> bytes;
  alignas(cmsghdr) std::array<char, 256> control;
  sockaddr_in from{};
  iovec into{bytes.data(), bytes.size()};
  msghdr message{};
  message.msg_name = &from;
  message.msg_namelen = sizeof from;
  message.msg_iov = &into;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t length = recvmsg(socket.file, &message, 0);
  if (length < 0) {
    // An ICMP answer to somebody's packet, or a signal: nothing to read now.
    if (errno == EAGAIN || errno == EINTR || errno == ECONNREFUSED || errno == ENETDOWN) return false;
    fail("receiving on UDP port " + std::to_string(socket.port), "");
  }
  UdpDatagram datagram;
  datagram.captured = now();
  uint32_t dropped = socket.dropped;
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part; part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SCM_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
      datagram.captured = Time{int64_t{stamp.tv_sec} * 1'000'000 + stamp.tv_nsec / 1000};
    } else if (part->cmsg_type == SO_RXQ_OVFL) {
      std::memcpy(&dropped, CMSG_DATA(part), sizeof dropped);
    }
  }
  datagram.source_address = ntohl(from.sin_addr.s_addr);
  datagram.destination_port = socket.port;
  datagram.payload.assign(bytes.begin(), bytes.begin() + length);
  const std::lock_guard lock(mutex_);
  health_.dropped_by_kernel += dropped - socket.dropped;
  socket.dropped = dropped;
  if (waiting_.size() < kMaxWaiting)
    waiting_.push_back(std::move(datagram));
  else
    ++health_.dropped_by_queue;
  arrived_.notify_one();
  return true;
}

}  // namespace sgraphs
