#include "common/base/notify_ready.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>

namespace sgraphs {
namespace {

// What notifyReady() says to a socket of this name; '@' stands for the abstract namespace.
std::string heardOn(const std::string& name) {
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, name.data(), name.size());
  if (name[0] == '@') address.sun_path[0] = '\0';
  EXPECT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address),
                   static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size())),
            0);
  ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
  notifyReady();
  ::unsetenv("NOTIFY_SOCKET");
  char buffer[64];
  const ssize_t size = ::recv(socket, buffer, sizeof buffer, 0);
  ::close(socket);
  if (name[0] == '/') ::unlink(name.c_str());
  return {buffer, static_cast<size_t>(size < 0 ? 0 : size)};
}

TEST(NotifyReadyTest, SystemdHearsIt) {
  const std::string pid = std::to_string(::getpid());
  EXPECT_EQ(heardOn("/tmp/sgraphs_notify_" + pid), "READY=1");
  EXPECT_EQ(heardOn("@sgraphs_notify_" + pid), "READY=1");
}

TEST(NotifyReadyTest, WithoutASocketNothingHappens) {
  ::unsetenv("NOTIFY_SOCKET");
  notifyReady();
  for (const std::string& wrong :
       {std::string("relative"), std::string("/tmp/nobody/listens"), "/" + std::string(200, 'x')}) {
    ::setenv("NOTIFY_SOCKET", wrong.c_str(), 1);
    notifyReady();
  }
  ::unsetenv("NOTIFY_SOCKET");
}

}  // namespace
}  // namespace sgraphs
