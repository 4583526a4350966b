#include "drivers/spot/stamp_mapper.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sgraphs {
namespace {

constexpr Duration kMaxSlew{250'000};
constexpr int64_t kPeriod_us = 20'000;

TEST(StampMapperTest, TheFirstSkewIsTakenAtOnce) {
  StampMapper mapper(1000, kMaxSlew);
  EXPECT_FALSE(mapper.setSkew({5'000'000}));
  EXPECT_EQ(mapper.step({7'000'000}), Time{2'000'000});
}

// spot_ros issue 88: stamps that jump with every new estimate of the clock.
TEST(StampMapperTest, ANewSkewIsApproachedAtTheBoundedRateAndReached) {
  for (const int64_t change_us : {40'000, -40'000}) {
    StampMapper mapper(1000, kMaxSlew);
    mapper.setSkew({0});
    Time last = *mapper.step({1'000'000});
    EXPECT_FALSE(mapper.setSkew({change_us}));
    Time robot{1'000'000};
    int steps = 0;
    for (; mapper.skewInForce() != Duration{change_us}; ++steps) {
      ASSERT_LT(steps, 10'000);
      robot = robot + Duration{kPeriod_us};
      const std::optional<Time> host = mapper.step(robot);
      ASSERT_TRUE(host);
      // 1000 ppm of 20 ms are 20 us.
      EXPECT_LE(std::abs((*host - last).us - kPeriod_us), 20);
      last = *host;
    }
    EXPECT_EQ(steps, 40'000 / 20);
  }
}

TEST(StampMapperTest, AClockThatWasSetIsFollowedAtOnce) {
  StampMapper mapper(1000, kMaxSlew);
  mapper.setSkew({0});
  mapper.step({1'000'000});
  EXPECT_TRUE(mapper.setSkew({3'600'000'000}));
  EXPECT_EQ(mapper.step({3'602'000'000}), Time{2'000'000});
}

TEST(StampMapperTest, StampsNeverRunBackwards) {
  StampMapper mapper(1000, kMaxSlew);
  mapper.setSkew({0});
  ASSERT_TRUE(mapper.step({2'000'000}));
  EXPECT_FALSE(mapper.step({2'000'000}));
  EXPECT_FALSE(mapper.step({1'900'000}));
  // The host's clock was set back by ten seconds: nothing until it has caught up.
  mapper.setSkew({10'000'000});
  EXPECT_FALSE(mapper.step({2'100'000}));
  EXPECT_EQ(mapper.step({12'000'001}), Time{2'000'001});
}

}  // namespace
}  // namespace sgraphs
