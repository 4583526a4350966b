#include "drivers/spot/time_sync.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

using Status = TimeSyncReply::Status;
constexpr Duration kMinute{60'000'000};
constexpr Duration kSecond{1'000'000};
constexpr RoundTrip kTrip{{1000}, {5'001'100}, {5'001'200}, {1400}};

TimeSyncReply reply(Status status, const std::string& id = "c1",
                    std::optional<int64_t> skew_us = std::nullopt) {
  TimeSyncReply r{status, id, std::nullopt, kTrip};
  if (skew_us) r.best = ClockEstimate{{*skew_us}, {300}};
  return r;
}

TEST(TimeSyncTest, TheFirstRequestIsEmptyAndTheNextReportsTheExchangeWithItsIdentifier) {
  TimeSync sync(kMinute);
  EXPECT_EQ(sync.request().clock_identifier, "");
  EXPECT_FALSE(sync.request().previous);
  sync.onReply(reply(Status::kMoreSamples), {10});
  EXPECT_EQ(sync.request().clock_identifier, "c1");
  ASSERT_TRUE(sync.request().previous);
  EXPECT_EQ(sync.request().previous->client_rx, Time{1400});
  EXPECT_FALSE(sync.synced());
  EXPECT_EQ(sync.due(), Time{10});
}

TEST(TimeSyncTest, NoExchangeIsReportedWithoutAnIdentifier) {
  TimeSync sync(kMinute);
  sync.onReply(reply(Status::kMoreSamples, ""), {10});
  EXPECT_FALSE(sync.request().previous);
}

TEST(TimeSyncTest, SyncedOnceTheRobotSaysSoAndLookedAtAgainEveryInterval) {
  TimeSync sync(kMinute);
  sync.onReply(reply(Status::kMoreSamples, "c1", 5), {10});
  EXPECT_FALSE(sync.synced());
  sync.onReply(reply(Status::kOk, "c1", 42), {20});
  ASSERT_TRUE(sync.synced());
  EXPECT_EQ(sync.estimate()->skew, Duration{42});
  EXPECT_EQ(sync.due(), Time{20} + kMinute);
  // A later look takes three rounds: its first still reports the exchange of a minute ago.
  const Time later = sync.due();
  for (int round = 0; round < 3; ++round) {
    EXPECT_EQ(sync.due(), later);
    sync.onReply(reply(Status::kOk, "c1", 43 + round), later);
  }
  EXPECT_EQ(sync.estimate()->skew, Duration{45});
  EXPECT_EQ(sync.due(), later + kMinute);
}

TEST(TimeSyncTest, RestsAfterTwentyFiveRoundsThatLedToNothing) {
  TimeSync sync(kMinute);
  for (int round = 0; round < 24; ++round) {
    sync.onReply(reply(Status::kMoreSamples), {10});
    ASSERT_EQ(sync.due(), Time{10}) << round;
  }
  sync.onReply(reply(Status::kMoreSamples), {10});
  EXPECT_EQ(sync.due(), Time{10} + kSecond);
}

TEST(TimeSyncTest, WaitsForAServiceThatIsNotReadyAndKeepsWhatIsKnown) {
  TimeSync sync(kMinute);
  sync.onReply(reply(Status::kNotReady), {10});
  EXPECT_TRUE(sync.robotNotReady());
  EXPECT_EQ(sync.due(), Time{10} + kSecond);
  sync.onReply(reply(Status::kOk, "c1", 42), {20});
  EXPECT_FALSE(sync.robotNotReady());
  sync.onReply(reply(Status::kNotReady), {30});
  EXPECT_EQ(sync.estimate()->skew, Duration{42});
}

TEST(TimeSyncTest, OkWithoutAnEstimateIsNotSynced) {
  TimeSync sync(kMinute);
  sync.onReply(reply(Status::kOk), {10});
  EXPECT_FALSE(sync.synced());
  TimeSyncReply negative = reply(Status::kOk, "c1", 42);
  negative.best->round_trip = {-1};
  sync.onReply(negative, {10});
  EXPECT_FALSE(sync.synced());
}

TEST(TimeSyncTest, AnotherIdentifierBeginsAgain) {
  TimeSync sync(kMinute);
  sync.onReply(reply(Status::kOk, "c1", 42), {20});
  sync.onReply(reply(Status::kMoreSamples, "c2", 7), {30});
  EXPECT_FALSE(sync.synced());
  EXPECT_EQ(sync.request().clock_identifier, "c2");
}

TEST(TimeSyncTest, ImpossibleExchangesAreNotReported) {
  for (const RoundTrip& trip :
       {RoundTrip{{1400}, {5}, {6}, {1000}}, RoundTrip{{1000}, {6}, {5}, {1400}},
        RoundTrip{{1000}, {5}, {6}, {20'000'000}}, RoundTrip{{1000}, {0}, {0}, {1400}}}) {
    TimeSync sync(kMinute);
    TimeSyncReply r = reply(Status::kMoreSamples);
    r.exchange = trip;
    sync.onReply(r, {10});
    EXPECT_FALSE(sync.request().previous);
  }
}

}  // namespace
}  // namespace sgraphs
