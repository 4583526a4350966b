#include "drivers/spot/token_keeper.h"

#include "common/base/error.h"

namespace sgraphs {

TokenKeeper::Action TokenKeeper::action(Time now) const {
  if (now < due_) return Action::kNone;
  return hasToken() ? Action::kRenew : Action::kLogin;
}

void TokenKeeper::onAnswer(AuthAnswer answer, const std::string& token, Time now) {
  const bool was_renewal = hasToken();
  locked_out_ = false;
  switch (answer) {
    case AuthAnswer::kGranted:
      if (token.empty()) return onNoAnswer(now);
      token_ = token;
      due_ = now + renewal_;
      unanswered_.reset();
      lockout_.reset();
      renewal_failed_.reset();
      return;
    case AuthAnswer::kWrongLogin:
      if (was_renewal) break;
      throw Error(
          "the robot refuses user and password: check SGRAPHS_SPOT_USER and SGRAPHS_SPOT_PASSWORD (or the "
          "credentials file); not tried again, because the robot locks an account after 6 refusals");
    case AuthAnswer::kLockedOut:
      // The token at hand goes on being used; without one there is nothing but to wait.
      locked_out_ = true;
      due_ = now + lockout_.next();
      return;
    case AuthAnswer::kTokenRefused:
      if (was_renewal) break;
      return onNoAnswer(now);
    case AuthAnswer::kUnknown:
      return onNoAnswer(now);
  }
  // A renewal was refused: the token is of no use any more, the password may be.
  onTokenExpired(now);
}

void TokenKeeper::onNoAnswer(Time now) {
  due_ = now + (hasToken() ? renewal_failed_.next() : unanswered_.next());
}

void TokenKeeper::onTokenExpired(Time now) {
  // Logged in again at once, unless fresh tokens are refused one after the other.
  token_.clear();
  const Time soonest = accepted_ ? now : now + expired_.next();
  due_ = locked_out_ ? std::max(due_, soonest) : soonest;
  accepted_ = false;
}

void TokenKeeper::onTokenAccepted() {
  accepted_ = true;
  expired_.reset();
}

}  // namespace sgraphs
