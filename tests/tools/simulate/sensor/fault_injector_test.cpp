#include "tools/simulate/sensor/fault_injector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace sgraphs::simulate {
namespace {

constexpr Time kStart{1700000000000000};
constexpr int kCount = 20000;

// A packet that carries its number in its first bytes.
SensorPacket numbered(int index) {
  SensorPacket packet;
  packet.time = kStart + Duration{std::llround(index * vlp16::kPacketPeriod_us)};
  packet.bytes.fill(0xAB);
  for (size_t i = 0; i < 4; ++i) packet.bytes[i] = static_cast<uint8_t>(index >> (8 * i));
  const uint32_t stamp = microsecondsPastHour(packet.time);
  for (size_t i = 0; i < 4; ++i) packet.bytes[1200 + i] = static_cast<uint8_t>(stamp >> (8 * i));
  return packet;
}

uint32_t read32(const SensorPacket& packet, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value |= static_cast<uint32_t>(packet.bytes[at + i]) << (8 * i);
  return value;
}

struct Outcome {
  std::vector<SensorPacket> packets;
  FaultCounts counts;
};

Outcome send(const FaultModel& model, uint64_t seed = 1, int count = kCount) {
  FaultInjector faults(model, seed, kStart);
  Outcome out;
  for (int i = 0; i < count; ++i)
    for (const SensorPacket& packet : faults.step(numbered(i))) out.packets.push_back(packet);
  for (const SensorPacket& packet : faults.finish()) out.packets.push_back(packet);
  out.counts = faults.counts();
  return out;
}

std::map<uint32_t, int> timesSeen(const Outcome& outcome) {
  std::map<uint32_t, int> seen;
  for (const SensorPacket& packet : outcome.packets) ++seen[read32(packet, 0)];
  return seen;
}

// Four standard deviations of a share of kCount packets.
double spread(double share) {
  return 4 * std::sqrt(kCount * share * (1 - share));
}

TEST(FaultInjectorTest, NothingHappensWithoutFaults) {
  const Outcome outcome = send({}, 1, 100);
  ASSERT_EQ(outcome.packets.size(), 100u);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(outcome.packets[static_cast<size_t>(i)].bytes, numbered(i).bytes);
    EXPECT_EQ(outcome.packets[static_cast<size_t>(i)].time, numbered(i).time);
  }
  EXPECT_EQ(outcome.counts.total(), 0);
}

TEST(FaultInjectorTest, LosesTheShareAskedFor) {
  FaultModel model;
  model.packet_loss = 0.1;
  const Outcome outcome = send(model);
  EXPECT_EQ(static_cast<int64_t>(outcome.packets.size()), kCount - outcome.counts.lost);
  EXPECT_NEAR(static_cast<double>(outcome.counts.lost), 0.1 * kCount, spread(0.1));
  EXPECT_EQ(timesSeen(outcome).size(), outcome.packets.size());
}

TEST(FaultInjectorTest, DuplicatesFollowTheirPacket) {
  FaultModel model;
  model.packet_duplicates = 0.05;
  const Outcome outcome = send(model);
  EXPECT_NEAR(static_cast<double>(outcome.counts.duplicated), 0.05 * kCount, spread(0.05));
  EXPECT_EQ(static_cast<int64_t>(outcome.packets.size()), kCount + outcome.counts.duplicated);
  int64_t repeated = 0;
  for (size_t i = 1; i < outcome.packets.size(); ++i)
    repeated += outcome.packets[i].bytes == outcome.packets[i - 1].bytes;
  EXPECT_EQ(repeated, outcome.counts.duplicated);
}

TEST(FaultInjectorTest, ReorderedPacketsChangePlacesWithTheNext) {
  FaultModel model;
  model.packet_reorders = 0.1;
  const Outcome outcome = send(model);
  ASSERT_EQ(outcome.packets.size(), static_cast<size_t>(kCount));
  EXPECT_EQ(timesSeen(outcome).size(), outcome.packets.size());
  int64_t swapped = 0;
  for (int i = 0; i < kCount; ++i) {
    const auto number = static_cast<int>(read32(outcome.packets[static_cast<size_t>(i)], 0));
    ASSERT_LE(std::abs(number - i), 1);
    swapped += number == i + 1;
  }
  EXPECT_EQ(swapped, outcome.counts.reordered);
  // A packet that was overtaken cannot overtake: shares of p / (1 + p).
  EXPECT_NEAR(static_cast<double>(swapped), kCount * 0.1 / 1.1, spread(0.1));
}

TEST(FaultInjectorTest, CorruptionTouchesAFewBytesOfTheShareAskedFor) {
  FaultModel model;
  model.packet_corruption = 0.1;
  const Outcome outcome = send(model);
  int64_t touched = 0;
  for (int i = 0; i < kCount; ++i) {
    const SensorPacket sent = numbered(i), &got = outcome.packets[static_cast<size_t>(i)];
    EXPECT_EQ(got.time, sent.time);
    int differing = 0;
    for (size_t k = 0; k < sent.bytes.size(); ++k) differing += sent.bytes[k] != got.bytes[k];
    EXPECT_LE(differing, 16);
    touched += differing > 0;
  }
  EXPECT_NEAR(static_cast<double>(outcome.counts.corrupted), 0.1 * kCount, spread(0.1));
  // Noise hits upon the old value now and then.
  EXPECT_LE(touched, outcome.counts.corrupted);
  EXPECT_GT(touched, outcome.counts.corrupted * 99 / 100);
}

TEST(FaultInjectorTest, SilencesHoldNoPacket) {
  FaultModel model;
  model.silences = {{2.0, 0.5}, {4.0, 1.0}};
  const Outcome outcome = send(model, 1, 5000);
  for (const SensorPacket& packet : outcome.packets) {
    const double seconds = (packet.time - kStart).seconds();
    EXPECT_FALSE(seconds >= 2.0 && seconds < 2.5) << seconds;
    EXPECT_FALSE(seconds >= 4.0 && seconds < 5.0) << seconds;
  }
  EXPECT_NEAR(static_cast<double>(outcome.counts.silenced), 1.5e6 / vlp16::kPacketPeriod_us, 2);
}

TEST(FaultInjectorTest, ClockJumpsChangeTheSensorsStampAlone) {
  FaultModel model;
  model.clock_jumps = {{1.0, 0.25}, {2.0, -3600.5}};
  for (const SensorPacket& packet : send(model, 1, 3000).packets) {
    const double seconds = (packet.time - kStart).seconds();
    const int64_t jumped = seconds < 1 ? 0 : seconds < 2 ? 250000 : 250000 - 3600500000;
    EXPECT_EQ(read32(packet, 1200), microsecondsPastHour(packet.time + Duration{jumped})) << seconds;
    EXPECT_EQ(packet.time, numbered(static_cast<int>(read32(packet, 0))).time);
  }
}

TEST(FaultInjectorTest, AllTogetherDependOnTheSeedAlone) {
  const FaultModel model{0.05, 0.05, 0.05, 0.05, {{1, 1}}, {{3, 1}}};
  const auto bytesOf = [](const Outcome& outcome) {
    std::vector<uint8_t> all;
    for (const SensorPacket& packet : outcome.packets)
      all.insert(all.end(), packet.bytes.begin(), packet.bytes.end());
    return all;
  };
  EXPECT_EQ(bytesOf(send(model, 3, 4000)), bytesOf(send(model, 3, 4000)));
  EXPECT_NE(bytesOf(send(model, 3, 4000)), bytesOf(send(model, 4, 4000)));
}

TEST(FaultInjectorTest, ALastPacketThatNobodyOvertakesStillArrives) {
  FaultModel model;
  model.packet_reorders = 1;
  const Outcome outcome = send(model, 1, 3);
  ASSERT_EQ(outcome.packets.size(), 3u);
  EXPECT_EQ(read32(outcome.packets[0], 0), 1u);
  EXPECT_EQ(read32(outcome.packets[2], 0), 2u);
}

}  // namespace
}  // namespace sgraphs::simulate
