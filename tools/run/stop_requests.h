#pragma once

#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

namespace sgraphs {

// SIGINT and SIGTERM as a question instead of an interruption, from this object's making on. To be made
// before any thread is.
class StopRequests {
 public:
  StopRequests() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    file_ = signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC);
  }
  ~StopRequests() { close(file_); }
  StopRequests(const StopRequests&) = delete;
  StopRequests& operator=(const StopRequests&) = delete;

  // One has come since the last call.
  bool come() {
    signalfd_siginfo info{};
    return read(file_, &info, sizeof info) == static_cast<ssize_t>(sizeof info);
  }

 private:
  int file_ = -1;
};

}  // namespace sgraphs
