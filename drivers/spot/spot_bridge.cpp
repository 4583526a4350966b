#include "drivers/spot/spot_bridge.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>

namespace sgraphs {
namespace {

constexpr const char* kStateService = "robot-state";
constexpr const char* kTimeService = "time-sync";
constexpr const char* kAuthCall = "auth";
constexpr const char* kDirectoryCall = "directory";
constexpr Duration kRestAfterError{1'000'000};  // after the robot answered with an error
constexpr Duration kResyncInterval{
    5'000'000};                      // at most so often because of a clock that seems to have jumped
constexpr int kMaxTimeouts = 3;      // in a row, then the connection counts as lost
constexpr size_t kMaxReasons = 100;  // texts that a robot may make up

std::string milliseconds(Duration d) {
  return fmt::format("{:.3f} ms", 1e3 * d.seconds());
}

}  // namespace

SpotBridge::SpotBridge(SpotRobot& robot, const SpotBridgeConfig& config, Credentials credentials,
                       SteadyClock clock)
    : robot_(robot),
      config_(config),
      credentials_(std::move(credentials)),
      clock_(std::move(clock)),
      token_(Duration::fromSeconds(config.token_renewal_s)),
      sync_(Duration::fromSeconds(config.time_sync_interval_s)),
      stamps_(config.max_slew_ppm, Duration::fromSeconds(config.max_stamp_error_s)),
      reconnect_(Duration::fromSeconds(config.reconnect_first_s),
                 Duration::fromSeconds(config.reconnect_max_s)),
      hindrance_("connecting to " + config.host) {}

std::optional<BodyOdometry> SpotBridge::step(bool poll) {
  const Time now = clock_();
  if (now < due_) return std::nullopt;
  due_ = now;
  if (const TokenKeeper::Action action = token_.action(now); action != TokenKeeper::Action::kNone) {
    authenticate(action);
  } else if (!token_.hasToken()) {
    due_ = token_.due();
  } else if (authorities_.size() < 2) {
    lookUp();
  } else if (now >= sync_.due()) {
    synchronise();
  } else if (!sync_.synced()) {
    due_ = sync_.due();
  } else if (poll && now >= poll_due_) {
    return pollState();
  } else {
    due_ = std::min({token_.due(), sync_.due(), poll ? poll_due_ : now + kRestAfterError});
  }
  return std::nullopt;
}

void SpotBridge::authenticate(TokenKeeper::Action action) {
  const bool renewal = action == TokenKeeper::Action::kRenew;
  const Answer<AuthReply> answer =
      renewal ? robot_.renew(credentials_.user, token_.token()) : robot_.login(credentials_);
  const Time now = clock_();
  if (!answer.ok()) {
    // Nothing was sent where nobody is there; all else may have been a refusal that got lost.
    if (renewal || answer.status != CallStatus::kUnavailable) token_.onNoAnswer(now);
    if (!renewal && answer.status != CallStatus::kUnavailable)
      hindrance_ = "the login was not answered (" + withoutSecrets(answer.why, credentials_, token_.token()) +
                   "); trying again in " + std::to_string((token_.due() - now).us / 1'000'000) + " s";
    return onFailure(kAuthCall,
                     answer.status == CallStatus::kUnauthenticated ? CallStatus::kRefused : answer.status,
                     answer.why);
  }
  const bool was_locked_out = token_.lockedOut();
  onAnswered(kAuthCall);
  token_.onAnswer(answer.value.answer, answer.value.token, now);
  if (token_.lockedOut() && !token_.hasToken()) hindrance_ = "the robot has locked the account out";
  if (token_.lockedOut() && !was_locked_out)
    spdlog::warn("the robot has locked the account out for too many refused logins; trying again in {} s",
                 (token_.due() - now).us / 1'000'000);
  if (token_.hasToken() && !renewal) {
    hindrance_.clear();
    spdlog::info("logged in");
  }
}

void SpotBridge::lookUp() {
  const char* service = authorities_.count(kTimeService) ? kStateService : kTimeService;
  const Answer<std::string> answer = robot_.authorityOf(service, token_.token());
  if (!answer.ok()) return onFailure(kDirectoryCall, answer.status, answer.why);
  onAnswered(kDirectoryCall);
  token_.onTokenAccepted();
  authorities_[service] = answer.value;
}

void SpotBridge::synchronise() {
  const Answer<TimeSyncReply> answer =
      robot_.syncTime(authorities_[kTimeService], token_.token(), sync_.request());
  const Time now = clock_();
  if (!answer.ok()) {
    sync_.onFailure(now);
    return onFailure(kTimeService, answer.status, answer.why);
  }
  onAnswered(kTimeService);
  token_.onTokenAccepted();
  const bool was_synced = sync_.synced();
  sync_.onReply(answer.value, now);
  if (!sync_.synced()) {
    hindrance_ = sync_.robotNotReady()
                     ? "not synchronised: the robot's clock service is not ready"
                     : "not synchronised: after " + std::to_string(sync_.rounds()) + " rounds";
    return;
  }
  hindrance_.clear();
  const Duration before = stamps_.skewInForce();
  if (stamps_.setSkew(sync_.estimate()->skew))
    spdlog::warn("a clock was set: the robot's is ahead by {} now, by {} before",
                 milliseconds(stamps_.skewInForce()), milliseconds(before));
  if (!was_synced)
    spdlog::info("synchronised: the robot's clock is ahead by {}, round trip {}",
                 milliseconds(sync_.estimate()->skew), milliseconds(sync_.estimate()->round_trip));
}

std::optional<BodyOdometry> SpotBridge::pollState() {
  const Stopwatch watch;
  const Answer<StateReply> answer = robot_.readState(authorities_[kStateService], token_.token());
  // In step with the rate, and without catching up on what a slow answer has left out.
  poll_due_ = std::max(poll_due_ + Duration::fromSeconds(1 / config_.poll_hz), clock_());
  if (!answer.ok()) {
    onFailure(kStateService, answer.status, answer.why);
    return std::nullopt;
  }
  latency_.add(watch.elapsedUs());
  onAnswered(kStateService);
  token_.onTokenAccepted();
  return sampleOf(answer.value);
}

std::optional<BodyOdometry> SpotBridge::sampleOf(const StateReply& reply) {
  const BodyStateResult body = bodyStateIn(reply.state, config_.frame);
  if (!body.state) {
    hindrance_ = "no odometry: " + body.refused;
    refuse(kStateService, body.refused);
    return std::nullopt;
  }
  const Time acquired = body.state->acquired_robot;
  if (last_acquired_ == acquired) {
    ++repeated_;
    return std::nullopt;
  }
  if (!isPlausible(stamps_.toHost(acquired), reply)) return std::nullopt;
  last_acquired_ = acquired;
  const std::optional<Time> host = stamps_.step(acquired);
  if (!host) {
    refuse(kStateService, "a stamp that is not later than the one before");
    return std::nullopt;
  }
  hindrance_.clear();
  speed_mps_ = body.state->twist_body ? body.state->twist_body->head<3>().norm() : 0;
  return BodyOdometry{*host, body.state->T_frame_body, body.state->twist_body};
}

// A state is acquired while its call is under way, or shortly before.
bool SpotBridge::isPlausible(Time host, const StateReply& reply) {
  const Duration tolerance = Duration::fromSeconds(config_.max_stamp_error_s);
  if (host >= reply.sent - tolerance && host <= reply.received + tolerance) return true;
  const Time now = clock_();
  hindrance_ = "not synchronised: stamps " + milliseconds(host - reply.received) + " off";
  refuse(kStateService,
         "acquired at another time than it was asked for: a clock jumped, or the state is old");
  if (!resynced_ || now - *resynced_ > kResyncInterval) {
    resynced_ = now;
    sync_.restart(now);
  }
  return false;
}

void SpotBridge::onAnswered(const std::string& call) {
  ++counts_[call].answered;
  timeouts_in_a_row_ = 0;
  reconnect_.reset();
  if (!std::exchange(outage_, false)) return;
  hindrance_.clear();
  spdlog::info("connected to {}", config_.host);
}

void SpotBridge::onFailure(const std::string& call, CallStatus status, const std::string& why) {
  switch (status) {
    case CallStatus::kUnauthenticated:
      ++counts_[call].refused;
      if (++reasons_["token"] == 1)
        spdlog::info("the robot does not accept the token any more: logging in again");
      return token_.onTokenExpired(clock_());
    case CallStatus::kRefused:
      hindrance_ = call + ": " + withoutSecrets(why, credentials_, token_.token());
      due_ = clock_() + kRestAfterError;
      return refuse(call, withoutSecrets(why, credentials_, token_.token()));
    case CallStatus::kTimeout:
      ++counts_[call].failed;
      if (++timeouts_in_a_row_ < kMaxTimeouts) return;
      return loseConnection(why);
    case CallStatus::kUnavailable:
      ++counts_[call].failed;
      return loseConnection(why);
    case CallStatus::kOk:
      return;
  }
}

void SpotBridge::refuse(const std::string& call, const std::string& why) {
  ++counts_[call].refused;
  if (reasons_.size() < kMaxReasons && ++reasons_[call + ": " + why] == 1) spdlog::warn("{}: {}", call, why);
}

void SpotBridge::loseConnection(const std::string& why) {
  const Time now = clock_();
  const std::string reason = withoutSecrets(why, credentials_, token_.token());
  robot_.disconnect();
  authorities_.clear();
  sync_.restart(now);
  timeouts_in_a_row_ = 0;
  due_ = now + reconnect_.next();
  hindrance_ = "no connection to " + config_.host + ": " + reason;
  if (!std::exchange(outage_, true))
    spdlog::warn("no connection to {}: {}; trying again until there is one", config_.host, reason);
}

std::string SpotBridge::state() const {
  if (token_.lockedOut() && !token_.hasToken())
    return hindrance_ + ": next login in " +
           std::to_string(std::max<int64_t>(0, (token_.due() - clock_()).us / 1'000'000)) + " s";
  if (!hindrance_.empty()) return hindrance_;
  if (!sync_.synced()) return "connecting to " + config_.host;
  return fmt::format("running: {}, skew {}, round trip {}, {:.2f} m/s", config_.frame,
                     milliseconds(stamps_.skewInForce()), milliseconds(sync_.estimate()->round_trip),
                     speed_mps_);
}

}  // namespace sgraphs
