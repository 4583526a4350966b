#include "drivers/velodyne/packet_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "drivers/velodyne/packet_stamps.h"

namespace sgraphs {
namespace {

constexpr int64_t kUtc_us = 472'222 * kHour_us;  // an hour's begin
constexpr double kPeriod_us = 1327.104;

// A sensor and a host with clocks of their own, packets that wait on their way, and what becomes of it.
class World {
 public:
  explicit World(PacketClock::Mode mode, double sensor_begin_us = 0, double begin_us = 0)
      : clock_(mode), sensor_us_(sensor_begin_us), true_us_(begin_us) {}

  double drift = 0;          // of the sensor's clock against the host's
  double host_shift_us = 0;  // of the host's clock against truth
  // Waiting of packet k; deterministic, sometimes none.
  double waiting_us(int k) const { return k % 10 == 3 ? 0.0 : 50.0 * ((k * 7919) % 23); }

  PacketClock::Stamp next() {
    const auto stamp = static_cast<uint32_t>(std::llround(sensor_us_) % kHour_us);
    return step(stamp);
  }
  PacketClock::Stamp step(uint32_t stamp) {
    const int64_t host = kUtc_us + std::llround(true_us_ + host_shift_us + waiting_us(count_++));
    const PacketClock::Stamp result = clock_.step(stamp, Time{host});
    if (result.published) {
      error_us_ = static_cast<double>(result.published->us - kUtc_us) - true_us_;
      backwards_ += newest_us_ >= result.published->us;
      newest_us_ = result.published->us;
    }
    silence(kPeriod_us * 1e-6);
    return result;
  }
  // Mean and worst of |published - truth| over so many packets.
  double worstOf(int packets) {
    double worst = 0;
    for (int i = 0; i < packets; ++i) {
      EXPECT_TRUE(next().published);
      worst = std::max(worst, std::abs(error_us_));
    }
    return worst;
  }
  void silence(double seconds) {
    true_us_ += 1e6 * seconds;
    sensor_us_ += 1e6 * seconds * (1.0 + drift);
  }
  void setSensor(double us) { sensor_us_ = us; }

  PacketClock clock_;
  double sensor_us_, true_us_, error_us_ = 0;
  int64_t newest_us_ = 0;
  int backwards_ = 0, count_ = 0;
};

TEST(PacketClockTest, AutoRemovesTheWaitingOfPackets) {
  World world(PacketClock::Mode::kAuto, 1234e6);
  world.worstOf(3000);
  EXPECT_LT(world.worstOf(3000), 20.0) << "packets wait up to 1100 us";
  EXPECT_EQ(world.backwards_, 0);
}

TEST(PacketClockTest, AutoKeepsTheIntervalsOfTheSensor) {
  World world(PacketClock::Mode::kAuto, 1234e6);
  world.worstOf(15000);
  Time previous = *world.next().published;
  for (int i = 0; i < 1000; ++i) {
    const Time now = *world.next().published;
    EXPECT_NEAR(static_cast<double>((now - previous).us), kPeriod_us, 2.0);
    previous = now;
  }
}

TEST(PacketClockTest, AutoFollowsAClockThatDrifts) {
  for (const double drift : {50e-6, -50e-6}) {
    World world(PacketClock::Mode::kAuto, 77e6);
    world.drift = drift;
    world.worstOf(80'000);  // 106 s: the clocks are 5 ms apart
    EXPECT_LT(world.worstOf(5000), 600.0) << drift;
    EXPECT_EQ(world.backwards_, 0);
  }
}

TEST(PacketClockTest, AFirstPacketThatWaitedLongIsForgotten) {
  PacketClock clock(PacketClock::Mode::kAuto);
  // The first packet comes 40 ms late, the others at once.
  Time newest = *clock.step(0, Time{kUtc_us + 40'000}).published;
  EXPECT_EQ(newest.us, kUtc_us + 40'000);
  double error_us = 40'000;
  for (int k = 1; k < 20'000; ++k) {
    const double t_us = k * kPeriod_us;
    const Time time = *clock.step(static_cast<uint32_t>(t_us), Time{kUtc_us + std::llround(t_us)}).published;
    EXPECT_GT(time, newest);
    newest = time;
    error_us = static_cast<double>(time.us - kUtc_us) - t_us;
  }
  EXPECT_LT(std::abs(error_us), 100.0);
}

TEST(PacketClockTest, TheHourWrapsUnseen) {
  for (const auto mode : {PacketClock::Mode::kAuto, PacketClock::Mode::kHost, PacketClock::Mode::kDevice}) {
    World world(mode, 3599.5e6, 3599.5e6);
    EXPECT_LT(world.worstOf(1000), 1200.0);
    EXPECT_EQ(world.backwards_, 0);
    EXPECT_EQ(world.clock_.sensorJumps(), 0);
  }
}

TEST(PacketClockTest, DeviceIsTheStampItselfWithTheHostsHour) {
  // The host is 20 minutes late, and in another hour.
  World world(PacketClock::Mode::kDevice, 600e6, 600e6);
  world.host_shift_us = -1200e6;
  EXPECT_LT(world.worstOf(2000), 1.5);
}

TEST(PacketClockTest, HostIsTheArrivalAndNeverRunsBackwards) {
  World world(PacketClock::Mode::kHost, 5e6);
  const double worst = world.worstOf(2000);
  EXPECT_GT(worst, 1000.0);
  EXPECT_LT(worst, 1200.0);
  EXPECT_EQ(world.backwards_, 0);
}

TEST(PacketClockTest, ASilenceOfAnyLengthChangesNothing) {
  for (const double silence_s : {3.0, 1500.0, 3599.0, 3600.0, 8000.0, 90'000.0}) {
    World world(PacketClock::Mode::kAuto, 100e6);
    world.drift = 20e-6;
    world.worstOf(5000);
    world.silence(silence_s);
    world.worstOf(20'000);
    EXPECT_LT(world.worstOf(2000), 400.0) << silence_s;
    EXPECT_EQ(world.clock_.sensorJumps() + world.clock_.hostJumps(), 0) << silence_s;
    EXPECT_EQ(world.backwards_, 0);
  }
}

TEST(PacketClockTest, ASensorThatRestartsIsCarriedOn) {
  for (const auto mode : {PacketClock::Mode::kAuto, PacketClock::Mode::kHost}) {
    World world(mode, 2000e6);
    world.worstOf(3000);
    world.silence(12);
    world.setSensor(1e6);
    const PacketClock::Stamp first = world.next();
    EXPECT_TRUE(first.stray);
    EXPECT_FALSE(first.published);
    EXPECT_LT(world.worstOf(3000), 2300.0);
    EXPECT_EQ(world.clock_.sensorJumps(), 1);
    EXPECT_EQ(world.backwards_, 0);
  }
}

TEST(PacketClockTest, DeviceFollowsAClockSetForwardAndNotOneSetBack) {
  World forward(PacketClock::Mode::kDevice, 600e6);
  forward.worstOf(1);
  forward.setSensor(1500e6);
  EXPECT_TRUE(forward.next().stray);
  EXPECT_TRUE(forward.next().published);
  EXPECT_NEAR(static_cast<double>(forward.newest_us_ - kUtc_us), 1500e6, 3000.0);

  World back(PacketClock::Mode::kDevice, 1500e6);
  back.next();
  const int64_t before_us = back.newest_us_;
  back.setSensor(600e6);
  EXPECT_TRUE(back.next().stray);
  for (int i = 0; i < 100; ++i) back.next();
  EXPECT_EQ(back.backwards_, 0);
  EXPECT_NEAR(static_cast<double>(back.newest_us_ - before_us), 99 * kPeriod_us, 3.0);
}

TEST(PacketClockTest, OneSpoiledStampCostsOnePacketAndNothingElse) {
  for (const auto mode : {PacketClock::Mode::kAuto, PacketClock::Mode::kDevice}) {
    World world(mode, 600e6, 600e6);
    world.worstOf(3000);
    EXPECT_TRUE(world.step(3'000'000'000).stray);
    EXPECT_LT(world.worstOf(3000), 1200.0);
    EXPECT_EQ(world.clock_.sensorJumps(), 0);
    EXPECT_EQ(world.backwards_, 0);
  }
}

TEST(PacketClockTest, RepeatedAndOvertakenPacketsAreNotPublishedAndChangeNothing) {
  World world(PacketClock::Mode::kAuto, 600e6);
  world.worstOf(3000);
  const auto stamp = static_cast<uint32_t>(std::llround(world.sensor_us_ - kPeriod_us));
  for (const uint32_t late : {stamp, stamp - 1327}) {
    const PacketClock::Stamp result = world.clock_.step(late, Time{kUtc_us + std::llround(world.true_us_)});
    EXPECT_FALSE(result.published);
    EXPECT_FALSE(result.stray);
  }
  EXPECT_LT(world.worstOf(1000), 1200.0);
}

TEST(PacketClockTest, AHostClockSetForwardIsFollowedAtOnce) {
  World world(PacketClock::Mode::kAuto, 600e6);
  world.worstOf(3000);
  world.host_shift_us = 30e6;
  world.next();
  EXPECT_EQ(world.clock_.hostJumps(), 1);
  for (int i = 0; i < 3000; ++i) world.next();
  EXPECT_NEAR(world.error_us_, 30e6, 100.0);
  EXPECT_EQ(world.clock_.hostJumps(), 1);
}

TEST(PacketClockTest, AHostClockSetBackIsNotFollowed) {
  for (const auto mode : {PacketClock::Mode::kAuto, PacketClock::Mode::kHost}) {
    World world(mode, 600e6);
    world.worstOf(3000);
    world.host_shift_us = -3600e6 + 5e6;
    for (int i = 0; i < 5000; ++i) EXPECT_TRUE(world.next().published);
    EXPECT_LT(std::abs(world.error_us_), 2500.0);
    EXPECT_EQ(world.clock_.hostJumps(), 1);
    EXPECT_EQ(world.backwards_, 0);
  }
}

}  // namespace
}  // namespace sgraphs
