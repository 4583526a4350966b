#include "drivers/spot/time_sync.h"

namespace sgraphs {
namespace {

constexpr Duration kRestAfterRounds{1'000'000};  // after rounds that led to nothing
constexpr Duration kMaxRoundTrip{10'000'000};
constexpr int kMaxRounds = 25;  // in a row
// The first round of a later look still reports the exchange of the look before.
constexpr int kRoundsPerLook = 3;

bool isPossible(const RoundTrip& trip) {
  const Duration round_trip = trip.client_rx - trip.client_tx;
  return round_trip >= Duration{0} && round_trip <= kMaxRoundTrip && trip.server_tx >= trip.server_rx &&
         trip.server_rx.us > 0;
}

bool isPossible(const ClockEstimate& estimate) {
  return estimate.round_trip >= Duration{0} && estimate.round_trip <= kMaxRoundTrip;
}

}  // namespace

void TimeSync::onReply(const TimeSyncReply& reply, Time now) {
  using Status = TimeSyncReply::Status;
  // Another identifier: the robot has forgotten us, and its clock may be another one.
  if (!request_.clock_identifier.empty() && reply.clock_identifier != request_.clock_identifier) restart(now);
  request_.clock_identifier = reply.clock_identifier;
  request_.previous.reset();
  if (isPossible(reply.exchange) && !reply.clock_identifier.empty()) request_.previous = reply.exchange;
  not_ready_ = reply.status == Status::kNotReady;
  if (reply.status == Status::kOk && reply.best && isPossible(*reply.best)) {
    const bool known = synced();
    estimate_ = reply.best;
    if (!known || ++rounds_ >= kRoundsPerLook) {
      rounds_ = 0;
      due_ = now + interval_;
    }
    return;
  }
  due_ = not_ready_ || ++rounds_ % kMaxRounds == 0 ? now + kRestAfterRounds : now;
}

void TimeSync::onFailure(Time now) {
  due_ = now + kRestAfterRounds;
}

void TimeSync::restart(Time now) {
  *this = TimeSync(interval_);
  due_ = now;
}

}  // namespace sgraphs
