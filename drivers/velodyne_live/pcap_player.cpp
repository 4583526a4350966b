#include "drivers/velodyne_live/pcap_player.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "common/base/error.h"

namespace sgraphs {
namespace {

constexpr size_t kMostAtOnce = 64;

}  // namespace

PcapPlayer::PcapPlayer(const std::string& path, double rate, std::optional<Time> begin)
    : reader_(path), rate_(rate) {
  next_ = reader_.next();
  if (!next_) throw Error("'" + path + "' holds no UDP datagram: is it a capture of the LiDAR's network?");
  if (begin) shift_ = *begin - next_->captured;
  next_->captured = next_->captured + shift_;
  first_ = now_ = next_->captured;
}

void PcapPlayer::advance() {
  next_ = reader_.next();
  if (next_) next_->captured = next_->captured + shift_;
}

double PcapPlayer::dueIn_s() const {
  return rate_ > 0 ? (next_->captured - first_).seconds() / rate_ - watch_.elapsedSeconds() : 0.0;
}

std::vector<UdpDatagram> PcapPlayer::take(int timeout_ms) {
  std::vector<UdpDatagram> taken;
  if (!next_) return taken;
  const double wait_s = std::min(dueIn_s(), timeout_ms * 1e-3);
  if (wait_s > 0) std::this_thread::sleep_for(std::chrono::duration<double>(wait_s));
  while (next_ && taken.size() < kMostAtOnce && dueIn_s() <= 0) {
    now_ = std::max(now_, next_->captured);
    taken.push_back(std::move(*next_));
    advance();
  }
  return taken;
}

}  // namespace sgraphs
