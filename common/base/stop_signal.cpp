#include "common/base/stop_signal.h"

#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

namespace sgraphs {
namespace {

sigset_t stopSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

}  // namespace

void StopSignal::block() {
  const sigset_t signals = stopSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

StopSignal::StopSignal() {
  const sigset_t signals = stopSignals();
  file_ = signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC);
}

StopSignal::~StopSignal() {
  close(file_);
}

bool StopSignal::requested() {
  signalfd_siginfo info{};
  return read(file_, &info, sizeof info) == static_cast<ssize_t>(sizeof info);
}

}  // namespace sgraphs
