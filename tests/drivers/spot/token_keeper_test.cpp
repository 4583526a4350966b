#include "drivers/spot/token_keeper.h"

#include <gtest/gtest.h>

#include <vector>

#include "common/base/error.h"

namespace sgraphs {
namespace {

using Action = TokenKeeper::Action;
constexpr Duration kHour{3'600'000'000};
constexpr int64_t kSecond_us = 1'000'000;

Time at(int64_t seconds) {
  return {seconds * kSecond_us};
}

TokenKeeper loggedIn(Time now) {
  TokenKeeper keeper(kHour);
  keeper.onAnswer(AuthAnswer::kGranted, "t1", now);
  return keeper;
}

TEST(TokenKeeperTest, LogsInAndRenewsBeforeExpiry) {
  TokenKeeper keeper(kHour);
  EXPECT_EQ(keeper.action(at(0)), Action::kLogin);
  keeper.onAnswer(AuthAnswer::kGranted, "t1", at(1));
  EXPECT_EQ(keeper.token(), "t1");
  EXPECT_EQ(keeper.action(at(3600)), Action::kNone);
  EXPECT_EQ(keeper.action(at(3601)), Action::kRenew);
  keeper.onAnswer(AuthAnswer::kGranted, "t2", at(3601));
  EXPECT_EQ(keeper.token(), "t2");
  EXPECT_EQ(keeper.action(at(7200)), Action::kNone);
}

TEST(TokenKeeperTest, ARefusedPasswordIsTheEnd) {
  TokenKeeper keeper(kHour);
  EXPECT_THROW(keeper.onAnswer(AuthAnswer::kWrongLogin, "", at(0)), Error);
}

TEST(TokenKeeperTest, ARefusedRenewalLogsInWithThePassword) {
  for (const AuthAnswer answer : {AuthAnswer::kTokenRefused, AuthAnswer::kWrongLogin}) {
    TokenKeeper keeper = loggedIn(at(0));
    keeper.onTokenAccepted();
    keeper.onAnswer(answer, "", at(3600));
    EXPECT_FALSE(keeper.hasToken());
    EXPECT_EQ(keeper.action(at(3600)), Action::kLogin);
  }
}

TEST(TokenKeeperTest, ARenewalWithoutAnswerKeepsTheTokenAndTriesAgainLater) {
  TokenKeeper keeper = loggedIn(at(0));
  keeper.onNoAnswer(at(3600));
  EXPECT_EQ(keeper.token(), "t1");
  EXPECT_EQ(keeper.action(at(3609)), Action::kNone);
  EXPECT_EQ(keeper.action(at(3610)), Action::kRenew);
}

// Six refusals lock the account for a minute: logins whose answer got lost may all have been refusals.
TEST(TokenKeeperTest, UnansweredLoginsStayBelowSixInFiveMinutes) {
  TokenKeeper keeper(kHour);
  std::vector<int64_t> logins;
  for (int64_t second = 0; second < 3600; ++second) {
    if (keeper.action(at(second)) != Action::kLogin) continue;
    logins.push_back(second);
    keeper.onNoAnswer(at(second));
  }
  ASSERT_GT(logins.size(), 6u);
  for (size_t i = 5; i < logins.size(); ++i) EXPECT_GE(logins[i] - logins[i - 5], 300);
}

TEST(TokenKeeperTest, ALockoutIsWaitedFor) {
  TokenKeeper keeper(kHour);
  keeper.onAnswer(AuthAnswer::kLockedOut, "", at(0));
  EXPECT_TRUE(keeper.lockedOut());
  EXPECT_EQ(keeper.action(at(64)), Action::kNone);
  EXPECT_EQ(keeper.action(at(65)), Action::kLogin);
  keeper.onAnswer(AuthAnswer::kLockedOut, "", at(65));
  EXPECT_EQ(keeper.action(at(65 + 129)), Action::kNone);
  keeper.onAnswer(AuthAnswer::kGranted, "t1", at(200));
  EXPECT_FALSE(keeper.lockedOut());
}

TEST(TokenKeeperTest, ALockoutDuringARenewalKeepsTheTokenAndOutlastsItsExpiry) {
  TokenKeeper keeper = loggedIn(at(0));
  keeper.onTokenAccepted();
  keeper.onAnswer(AuthAnswer::kLockedOut, "", at(3600));
  EXPECT_EQ(keeper.token(), "t1");
  keeper.onTokenExpired(at(3610));
  EXPECT_EQ(keeper.action(at(3611)), Action::kNone);
  EXPECT_EQ(keeper.action(at(3665)), Action::kLogin);
}

TEST(TokenKeeperTest, AnExpiredTokenLogsInAtOnce) {
  TokenKeeper keeper = loggedIn(at(0));
  keeper.onTokenAccepted();
  keeper.onTokenExpired(at(100));
  EXPECT_EQ(keeper.action(at(100)), Action::kLogin);
}

TEST(TokenKeeperTest, FreshTokensThatAreRefusedDoNotHammerTheLogin) {
  TokenKeeper keeper(kHour);
  int logins = 0;
  for (int64_t second = 0; second < 600; ++second) {
    if (keeper.action(at(second)) != Action::kLogin) continue;
    ++logins;
    keeper.onAnswer(AuthAnswer::kGranted, "t" + std::to_string(second), at(second));
    keeper.onTokenExpired(at(second));
  }
  EXPECT_LT(logins, 20);
  EXPECT_GT(logins, 5);
}

TEST(TokenKeeperTest, AGrantWithoutATokenIsNoAnswer) {
  TokenKeeper keeper(kHour);
  keeper.onAnswer(AuthAnswer::kGranted, "", at(0));
  EXPECT_FALSE(keeper.hasToken());
  EXPECT_EQ(keeper.action(at(1)), Action::kNone);
}

TEST(BackoffTest, DoublesUpToTheLongest) {
  Backoff backoff({500}, {3000});
  for (const int64_t pause_us : {500, 1000, 2000, 3000, 3000}) EXPECT_EQ(backoff.next().us, pause_us);
  backoff.reset();
  EXPECT_EQ(backoff.next().us, 500);
}

}  // namespace
}  // namespace sgraphs
