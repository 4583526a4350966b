#include "tools/simulate/sensor/fault_injector.h"

#include <algorithm>
#include <utility>

#include "tools/simulate/sensor/random_stream.h"

namespace sgraphs::simulate {
namespace {

constexpr uint64_t kSeed = 0x6661756c7473;  // apart from the streams of firings and legs
constexpr int kMostNoisyBytes = 16;
constexpr size_t kStampAt = 1200;
constexpr int64_t kHour_us = 3600000000;

int64_t below(RandomStream& random, int64_t count) {
  return std::min(count - 1, static_cast<int64_t>(random.uniform() * static_cast<double>(count)));
}

void corrupt(SensorPacket& packet, RandomStream& random) {
  const int64_t bytes = 1 + below(random, kMostNoisyBytes);
  for (int64_t i = 0; i < bytes; ++i) {
    const auto at = static_cast<size_t>(below(random, vlp16::kPacketBytes));
    packet.bytes[at] = static_cast<uint8_t>(below(random, 256));
  }
}

}  // namespace

FaultInjector::FaultInjector(FaultModel model, uint64_t seed, Time start)
    : model_(std::move(model)), seed_(seed ^ kSeed), start_(start) {}

bool FaultInjector::silent(Time time) const {
  const double seconds = (time - start_).seconds();
  return std::any_of(model_.silences.begin(), model_.silences.end(), [&](const FaultModel::Silence& s) {
    return seconds >= s.begin_s && seconds < s.begin_s + s.duration_s;
  });
}

void FaultInjector::jumpClock(SensorPacket& packet) const {
  int64_t by_us = 0;
  for (const FaultModel::ClockJump& jump : model_.clock_jumps)
    if ((packet.time - start_).seconds() >= jump.at_s) by_us += Duration::fromSeconds(jump.by_s).us;
  if (by_us == 0) return;
  uint32_t stamp = 0;
  for (size_t i = 0; i < 4; ++i) stamp |= static_cast<uint32_t>(packet.bytes[kStampAt + i]) << (8 * i);
  const int64_t jumped = ((static_cast<int64_t>(stamp) + by_us) % kHour_us + kHour_us) % kHour_us;
  for (size_t i = 0; i < 4; ++i) packet.bytes[kStampAt + i] = static_cast<uint8_t>(jumped >> (8 * i));
}

std::vector<SensorPacket> FaultInjector::step(const SensorPacket& packet) {
  RandomStream random(seed_, next_index_++);
  const bool lost = random.uniform() < model_.packet_loss;
  const bool duplicated = random.uniform() < model_.packet_duplicates;
  const bool reordered = random.uniform() < model_.packet_reorders;
  const bool corrupted = random.uniform() < model_.packet_corruption;
  if (silent(packet.time)) {
    ++counts_.silenced;
    return {};
  }
  if (lost) {
    ++counts_.lost;
    return {};
  }
  SensorPacket arriving = packet;
  jumpClock(arriving);
  if (corrupted) corrupt(arriving, random);
  counts_.corrupted += corrupted;
  counts_.duplicated += duplicated;
  std::vector<SensorPacket> out(duplicated ? 2 : 1, arriving);
  if (!held_.empty()) {
    ++counts_.reordered;
    out.insert(out.end(), held_.begin(), held_.end());
    held_.clear();
  } else if (reordered) {
    held_.swap(out);
  }
  return out;
}

std::vector<SensorPacket> FaultInjector::finish() {
  return std::exchange(held_, {});
}

}  // namespace sgraphs::simulate
