#include <arpa/inet.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "common/base/error.h"
#include "common/base/performance.h"
#include "common/bus/lcm_bus.h"
#include "tools/run/doctor.h"

namespace sgraphs {
namespace {

using Level = Finding::Level;

constexpr size_t kVelodynePacket_bytes = 1206;
// The largest of our messages; a keyframe is a handful of them.
constexpr size_t kProbe_bytes = 60'000;
constexpr int kProbes = 20;

class Socket {
 public:
  explicit Socket(int type) : fd(socket(AF_INET, type | SOCK_CLOEXEC, 0)) {}
  ~Socket() {
    if (fd >= 0) close(fd);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  const int fd;
};

sockaddr_in addressOf(in_addr_t ip, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = ip;
  address.sin_port = htons(static_cast<uint16_t>(port));
  return address;
}

const sockaddr* plain(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

// The interface that has this address, and whether it carries multicast.
std::pair<std::string, bool> interfaceOf(in_addr ip) {
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return {"?", false};
  std::pair<std::string, bool> found{"?", false};
  for (const ifaddrs* i = all; i; i = i->ifa_next) {
    if (!i->ifa_addr || i->ifa_addr->sa_family != AF_INET) continue;
    const auto* address = reinterpret_cast<const sockaddr_in*>(i->ifa_addr);
    if (address->sin_addr.s_addr == ip.s_addr) found = {i->ifa_name, (i->ifa_flags & IFF_MULTICAST) != 0};
  }
  freeifaddrs(all);
  return found;
}

int64_t valueIn(const std::string& url, const std::string& key, int64_t otherwise) {
  for (const char before : {'?', '&'})
    if (const size_t at = url.find(before + key + "="); at != std::string::npos)
      return std::atoll(url.c_str() + at + key.size() + 2);
  return otherwise;
}

bool bound(const Socket& socket, int port) {
  const sockaddr_in address = addressOf(htonl(INADDR_ANY), port);
  return bind(socket.fd, plain(address), sizeof address) == 0;
}

bool readable(int fd, short what, double seconds) {
  pollfd wait{fd, what, 0};
  return poll(&wait, 1, static_cast<int>(seconds * 1000)) > 0;
}

}  // namespace

MulticastUrl parseMulticastUrl(const std::string& url) {
  MulticastUrl parts;
  const std::string scheme = "udpm://";
  parts.is_udpm = url.compare(0, scheme.size(), scheme) == 0;
  if (!parts.is_udpm) return parts;
  const std::string place = url.substr(scheme.size(), url.find('?') - std::min(url.find('?'), scheme.size()));
  const size_t colon = place.find(':');
  parts.address = place.substr(0, colon);
  if (parts.address.empty()) parts.address = "239.255.76.67";
  parts.port = colon == std::string::npos ? 7667 : std::atoi(place.c_str() + colon + 1);
  parts.ttl = static_cast<int>(valueIn(url, "ttl", 0));
  parts.recv_buf_size = valueIn(url, "recv_buf_size", 0);
  return parts;
}

Finding checkRoute(const std::string& lcm_url) {
  const std::string name = "multicast route",
                    mend =
                        "ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo "
                        "(on a robot: dev and the interface of its network)";
  const MulticastUrl url = parseMulticastUrl(lcm_url);
  if (!url.is_udpm) return {name, Level::kOk, "not needed by " + lcm_url, ""};
  const Socket socket(SOCK_DGRAM);
  const sockaddr_in group = addressOf(inet_addr(url.address.c_str()), url.port);
  if (connect(socket.fd, plain(group), sizeof group) != 0)
    return {name, Level::kFail, "none to " + url.address + " (" + std::strerror(errno) + ")", mend};
  sockaddr_in own{};
  socklen_t size = sizeof own;
  getsockname(socket.fd, reinterpret_cast<sockaddr*>(&own), &size);
  const auto [interface, multicast] = interfaceOf(own.sin_addr);
  if (!multicast)
    return {name, Level::kFail, url.address + " leaves by " + interface + ", which does not carry multicast",
            "ip link set " + interface + " multicast on"};
  return {name, Level::kOk, url.address + ":" + std::to_string(url.port) + " by " + interface, ""};
}

Finding checkTtl(const std::string& lcm_url) {
  const std::string name = "multicast TTL";
  const MulticastUrl url = parseMulticastUrl(lcm_url);
  if (!url.is_udpm) return {name, Level::kOk, "not needed", ""};
  if (url.ttl == 0) return {name, Level::kOk, "0: messages stay on this machine", ""};
  if (url.ttl == 1) return {name, Level::kOk, "1: messages reach this machine's network", ""};
  return {name, Level::kWarn, std::to_string(url.ttl) + ": messages pass routers",
          "ttl=1 is enough for several machines on one network"};
}

// Messages as large as ours, as fast as they come.
Finding checkRoundTrip(const std::string& lcm_url) {
  const std::string name = "LCM round trip", channel = "SGRAPHS_DOCTOR";
  try {
    LcmBus sender(lcm_url), reader(lcm_url);
    int heard = 0;
    reader.subscribe(channel, [&heard](Bus::Bytes bytes) { heard += bytes.size() == kProbe_bytes ? 1 : 0; });
    const std::vector<uint8_t> probe(kProbe_bytes);
    for (int i = 0; i < kProbes; ++i) sender.publish(channel, probe);
    const Stopwatch watch;
    while (heard < kProbes && watch.elapsedSeconds() < 1) reader.dispatch(50);
    const std::string found =
        std::to_string(heard) + " of " + std::to_string(kProbes) + " messages of 60 kB came back";
    if (heard == kProbes) return {name, Level::kOk, found, ""};
    if (heard > 0) return {name, Level::kWarn, found, "sysctl -w net.core.rmem_max=8388608"};
    return {name, Level::kFail, found, "look at the firewall: UDP to the group of " + lcm_url};
  } catch (const Error& e) {
    return {name, Level::kFail, e.what(), "mend the multicast route first"};
  }
}

Finding checkReceiveBuffer(const std::string& lcm_url, int64_t rmem_max) {
  const std::string name = "receive buffer";
  const MulticastUrl url = parseMulticastUrl(lcm_url);
  if (!url.is_udpm) return {name, Level::kOk, "not needed", ""};
  const int64_t granted = std::min(url.recv_buf_size, rmem_max);
  // A VLP-16 sends 1 MB/s: a process that is held up for so long loses nothing.
  const std::string found = std::to_string(granted) + " bytes (" + std::to_string(granted / 1000) +
                            " ms of a LiDAR) of " + std::to_string(url.recv_buf_size) + " asked for";
  if (granted >= url.recv_buf_size && url.recv_buf_size >= 2'000'000) return {name, Level::kOk, found, ""};
  return {name, Level::kWarn, found,
          url.recv_buf_size < 2'000'000
              ? "give the URL recv_buf_size=4000000"
              : "sysctl -w net.core.rmem_max=8388608 (and in /etc/sysctl.d, to keep it)"};
}

Finding checkPort(const std::string& name, int port) {
  const Socket socket(SOCK_DGRAM);
  const std::string text = "UDP " + std::to_string(port);
  if (bound(socket, port)) return {name, Level::kOk, text + " is free", ""};
  if (errno == EADDRINUSE)
    return {name, Level::kFail, text + " is taken by another program",
            "end it: ss -ulpn 'sport = :" + std::to_string(port) + "' names it"};
  return {name, Level::kFail, text + ": " + std::strerror(errno), "choose another port"};
}

Finding checkSensor(int port, double patience_s) {
  const std::string name = "LiDAR";
  const Socket socket(SOCK_DGRAM);
  if (!bound(socket, port))
    return {name, Level::kWarn, std::string("cannot listen: ") + std::strerror(errno), ""};
  const Stopwatch watch;
  int64_t packets = 0, others = 0;
  std::string from;
  while (watch.elapsedSeconds() < patience_s) {
    if (!readable(socket.fd, POLLIN, patience_s - watch.elapsedSeconds())) break;
    uint8_t bytes[2048];
    sockaddr_in source{};
    socklen_t size = sizeof source;
    const ssize_t n =
        recvfrom(socket.fd, bytes, sizeof bytes, 0, reinterpret_cast<sockaddr*>(&source), &size);
    if (n != static_cast<ssize_t>(kVelodynePacket_bytes)) {
      ++others;
      continue;
    }
    ++packets;
    from = inet_ntoa(source.sin_addr);
    if (packets >= 100) break;
  }
  if (packets > 0) return {name, Level::kOk, "packets from " + from, ""};
  if (others > 0)
    return {name, Level::kFail, std::to_string(others) + " datagrams came, none of 1206 bytes",
            "is it a VLP-16? another program may send to UDP " + std::to_string(port)};
  char found[64];
  std::snprintf(found, sizeof found, "no packet within %.0f s", patience_s);
  return {name, Level::kWarn, found,
          "is it on, is the cable in, and is this machine's address its destination (http://192.168.1.201)?"};
}

Finding checkRobot(const std::string& host, int port) {
  const std::string name = "robot", place = host + ":" + std::to_string(port);
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found); error != 0)
    return {name, Level::kFail, "'" + host + "' is no address: " + gai_strerror(error), "check the name"};
  const Socket socket(SOCK_STREAM);
  fcntl(socket.fd, F_SETFL, O_NONBLOCK);
  const int connected = connect(socket.fd, found->ai_addr, found->ai_addrlen);
  int error = connected == 0 ? 0 : errno;
  freeaddrinfo(found);
  if (error == EINPROGRESS) {
    socklen_t size = sizeof error;
    if (!readable(socket.fd, POLLOUT, 2))
      error = ETIMEDOUT;
    else
      getsockopt(socket.fd, SOL_SOCKET, SO_ERROR, &error, &size);
  }
  if (error == 0) return {name, Level::kOk, place + " answers", ""};
  return {name, Level::kFail, place + ": " + std::strerror(error),
          "is this machine on the robot's network (ping " + host + ")?"};
}

}  // namespace sgraphs
