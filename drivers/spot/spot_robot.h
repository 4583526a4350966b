#pragma once

#include <string>

#include "drivers/spot/body_state.h"
#include "drivers/spot/credentials.h"
#include "drivers/spot/time_sync.h"
#include "drivers/spot/token_keeper.h"

namespace sgraphs {

// How a call ended.
enum class CallStatus {
  kOk,
  kUnauthenticated,  // the token is not (or no longer) valid
  kUnavailable,      // nobody there, or the connection broke
  kTimeout,          // no answer within the deadline; the call may have been carried out
  kRefused,          // the robot answered with an error
};

// An answer, or `why` there is none; the text may hold what the other side chose to write.
template <typename Value>
struct Answer {
  CallStatus status = CallStatus::kOk;
  std::string why;
  Value value{};
  bool ok() const { return status == CallStatus::kOk; }
};

struct AuthReply {
  AuthAnswer answer = AuthAnswer::kUnknown;
  std::string token;
};

// A robot's state, and when the call was made in the host's clock.
struct StateReply {
  RobotState state;
  Time sent, received;
};

// A robot's services, one call at a time; every call returns within its deadline. Authorities, by which a
// robot's one address tells its services apart, come from the directory; those of login and directory are
// fixed.
class SpotRobot {
 public:
  virtual ~SpotRobot() = default;

  // Forgets all connections: the next call makes new ones.
  virtual void disconnect() = 0;

  // kUnavailable only if nothing was sent; else a login without answer may have been refused.
  virtual Answer<AuthReply> login(const Credentials& credentials) = 0;
  virtual Answer<AuthReply> renew(const std::string& user, const std::string& token) = 0;
  virtual Answer<std::string> authorityOf(const std::string& service, const std::string& token) = 0;
  virtual Answer<TimeSyncReply> syncTime(const std::string& authority, const std::string& token,
                                         const TimeSyncRequest& request) = 0;
  virtual Answer<StateReply> readState(const std::string& authority, const std::string& token) = 0;
};

}  // namespace sgraphs
