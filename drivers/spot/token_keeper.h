#pragma once

#include <string>

#include "common/base/time.h"
#include "drivers/spot/backoff.h"

namespace sgraphs {

// The robot's answer to a login or a renewal.
enum class AuthAnswer { kGranted, kWrongLogin, kTokenRefused, kLockedOut, kUnknown };

// When to log in and when to renew the token. Six refused passwords lock an account for a minute (Spot's
// documentation), so: a refused password is never sent again, an unanswered login counts as one that may have
// been refused, and a lockout is waited for. `now` is of a clock that never jumps. Pure: sends nothing
// itself.
class TokenKeeper {
 public:
  enum class Action { kNone, kLogin, kRenew };

  explicit TokenKeeper(Duration renewal) : renewal_(renewal) {}

  // What to do at this time. kNone without a token means: wait until due().
  Action action(Time now) const;
  Time due() const { return due_; }
  bool lockedOut() const { return locked_out_; }

  // The answer to what action() asked for. Throws Error if the password is refused: the end of the process.
  void onAnswer(AuthAnswer answer, const std::string& token, Time now);
  // The login was sent and no answer came.
  void onNoAnswer(Time now);
  // A call was refused because of its token: it has expired, or the robot has forgotten it.
  void onTokenExpired(Time now);
  // A call with the token was answered.
  void onTokenAccepted();

  bool hasToken() const { return !token_.empty(); }
  const std::string& token() const { return token_; }

 private:
  Duration renewal_;
  std::string token_;
  Time due_;
  bool locked_out_ = false;
  bool accepted_ = false;  // a call was answered with the token at hand
  Backoff expired_{{1'000'000}, {60'000'000}};
  Backoff unanswered_{{15'000'000}, {300'000'000}};
  Backoff lockout_{{65'000'000}, {600'000'000}};
  Backoff renewal_failed_{{10'000'000}, {300'000'000}};
};

}  // namespace sgraphs
