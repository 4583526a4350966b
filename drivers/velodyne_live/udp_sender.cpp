#include "drivers/velodyne_live/udp_sender.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "common/base/error.h"

namespace sgraphs {

UdpSender::UdpSender(uint32_t address) : address_(address) {
  file_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  if (file_ < 0 || setsockopt(file_, SOL_SOCKET, SO_BROADCAST, &yes, sizeof yes) != 0)
    throw Error(std::string("cannot open a UDP socket: ") + std::strerror(errno));
}

UdpSender::~UdpSender() {
  close(file_);
}

void UdpSender::send(uint16_t port, std::span<const uint8_t> payload) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(address_);
  const ssize_t sent =
      sendto(file_, payload.data(), payload.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  if (sent < 0 && errno != ECONNREFUSED)
    throw Error("cannot send to port " + std::to_string(port) + ": " + std::strerror(errno) +
                "; check the address and the route to it");
}

}  // namespace sgraphs
