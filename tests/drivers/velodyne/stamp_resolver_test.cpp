#include "drivers/velodyne/stamp_resolver.h"

#include <gtest/gtest.h>

#include "drivers/velodyne/packet_stamps.h"

namespace sgraphs {
namespace {

constexpr int64_t kHour = 472'222 * kHour_us;  // in November 2023

uint32_t stampOf(int64_t us) {
  return static_cast<uint32_t>(((us % kHour_us) + kHour_us) % kHour_us);
}

TEST(StampResolverTest, TheHostChoosesTheHourOnly) {
  StampResolver resolver;
  EXPECT_EQ(resolver.resolve(800'000'000, Time{kHour + 800'004'321}).us, kHour + 800'000'000);
  EXPECT_TRUE(resolver.synchronised());
  EXPECT_EQ(resolver.resolve(800'001'327, Time{kHour + 803'000'000}).us, kHour + 800'001'327);
}

TEST(StampResolverTest, AHostBeyondTheHourBoundaryTakesTheHourBefore) {
  StampResolver late, early;
  EXPECT_EQ(late.resolve(stampOf(kHour_us - 500), Time{kHour + 700}).us, kHour - 500);
  EXPECT_EQ(early.resolve(500, Time{kHour - 900}).us, kHour + 500);
}

TEST(StampResolverTest, TimeGoesOnOverTheHour) {
  for (const bool with_host : {true, false})
    for (const int64_t offset_us : {int64_t{0}, int64_t{1'234'567'890}}) {
      StampResolver resolver;
      const int64_t start = kHour - 5'000;
      Time previous = resolver.resolve(stampOf(start + offset_us), Time{start + 40});
      for (int i = 1; i < 10; ++i) {
        const int64_t now = start + 1327 * i;
        const std::optional<Time> host =
            with_host ? std::optional(Time{now + 40 + (i % 3) * 300}) : std::nullopt;
        const Time time = resolver.resolve(stampOf(now + offset_us), host);
        EXPECT_EQ((time - previous).us, 1327) << "offset " << offset_us << ", host " << with_host;
        previous = time;
      }
      EXPECT_EQ(resolver.clockJumps(), 0);
    }
}

TEST(StampResolverTest, AFreeRunningClockIsCarriedOntoTheHost) {
  StampResolver resolver;
  const int64_t power_up = kHour + 1'000'000'000;
  EXPECT_EQ(resolver.resolve(2'000'000, Time{power_up}).us, power_up);
  EXPECT_FALSE(resolver.synchronised());
  // The host's jitter does not enter.
  EXPECT_EQ(resolver.resolve(2'001'327, Time{power_up + 9'000}).us, power_up + 1327);
  // Hours later, too.
  const int64_t later = 5 * kHour_us + 77;
  EXPECT_EQ(resolver.resolve(stampOf(2'000'000 + later), Time{power_up + later + 2'000'000}).us,
            power_up + later);
}

TEST(StampResolverTest, ACarriedClockBeginsExactlyWhereItIsTold) {
  StampResolver resolver(StampResolver::Clock::kCarried);
  EXPECT_EQ(resolver.resolve(800'000'300, Time{kHour + 800'000'000}).us, kHour + 800'000'000);
  EXPECT_EQ(resolver.resolve(800'001'627, std::nullopt).us, kHour + 800'001'327);
}

TEST(StampResolverTest, ARestartedSensorIsAnchoredAnew) {
  StampResolver resolver;
  const int64_t start = kHour + 1'000'000'000;
  resolver.resolve(700'000'000, Time{start});
  const int64_t restart = start + 30'000'000;
  EXPECT_EQ(resolver.resolve(1'000, Time{restart}).us, restart);
  EXPECT_EQ(resolver.resolve(2'327, Time{restart + 1'400}).us, restart + 1'327);
  EXPECT_EQ(resolver.clockJumps(), 1);
}

TEST(StampResolverTest, AHostClockSetAnewMovesNothing) {
  StampResolver resolver;
  const int64_t start = kHour + 1'000'000'000;
  resolver.resolve(10, Time{start});
  EXPECT_EQ(resolver.resolve(1'337, Time{start + 60'000'000}).us, start + 1'327);
  EXPECT_EQ(resolver.clockJumps(), 0);
}

}  // namespace
}  // namespace sgraphs
