#include "drivers/spot/wire.h"

namespace sgraphs::wire {
namespace {

constexpr int64_t kMicrosecondsPerSecond = 1'000'000;
constexpr int64_t kNanosecondsPerMicrosecond = 1000;
// Beyond this many seconds a stamp is none, and its microseconds would not fit.
constexpr int64_t kMaxSeconds = 100'000'000'000;
constexpr const char* kClientName = "sgraphs-spot-bridge";

int64_t microseconds(int64_t seconds, int32_t nanoseconds) {
  if (seconds > kMaxSeconds || seconds < -kMaxSeconds) return 0;
  return seconds * kMicrosecondsPerSecond + nanoseconds / kNanosecondsPerMicrosecond;
}

template <typename Wire>
Wire secondsAndNanoseconds(int64_t us) {
  Wire wire;
  wire.set_seconds(us / kMicrosecondsPerSecond);
  wire.set_nanos(static_cast<int32_t>(us % kMicrosecondsPerSecond * kNanosecondsPerMicrosecond));
  return wire;
}

Eigen::Vector3d fromWire(const bosdyn::api::Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

SE3 fromWire(const bosdyn::api::SE3Pose& pose) {
  const bosdyn::api::Quaternion& q = pose.rotation();
  return {Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()), fromWire(pose.position())};
}

RobotState::Velocity fromWire(const bosdyn::api::SE3Velocity& velocity) {
  return {fromWire(velocity.linear()), fromWire(velocity.angular())};
}

TimeSyncReply::Status fromWire(bosdyn::api::TimeSyncState::Status status) {
  switch (status) {
    case bosdyn::api::TimeSyncState::STATUS_OK:
      return TimeSyncReply::Status::kOk;
    case bosdyn::api::TimeSyncState::STATUS_MORE_SAMPLES_NEEDED:
      return TimeSyncReply::Status::kMoreSamples;
    case bosdyn::api::TimeSyncState::STATUS_SERVICE_NOT_READY:
      return TimeSyncReply::Status::kNotReady;
    default:
      return TimeSyncReply::Status::kUnknown;
  }
}

}  // namespace

Time fromWire(const google::protobuf::Timestamp& stamp) {
  return {microseconds(stamp.seconds(), stamp.nanos())};
}

Duration fromWire(const google::protobuf::Duration& duration) {
  return {microseconds(duration.seconds(), duration.nanos())};
}

google::protobuf::Timestamp toWire(Time time) {
  return secondsAndNanoseconds<google::protobuf::Timestamp>(time.us);
}

google::protobuf::Duration toWire(Duration duration) {
  return secondsAndNanoseconds<google::protobuf::Duration>(duration.us);
}

bosdyn::api::RequestHeader requestHeader(Time now) {
  bosdyn::api::RequestHeader header;
  *header.mutable_request_timestamp() = toWire(now);
  header.set_client_name(kClientName);
  return header;
}

AuthAnswer fromWire(bosdyn::api::GetAuthTokenResponse::Status status) {
  switch (status) {
    case bosdyn::api::GetAuthTokenResponse::STATUS_OK:
      return AuthAnswer::kGranted;
    case bosdyn::api::GetAuthTokenResponse::STATUS_INVALID_LOGIN:
      return AuthAnswer::kWrongLogin;
    case bosdyn::api::GetAuthTokenResponse::STATUS_INVALID_TOKEN:
      return AuthAnswer::kTokenRefused;
    case bosdyn::api::GetAuthTokenResponse::STATUS_TEMPORARILY_LOCKED_OUT:
      return AuthAnswer::kLockedOut;
    default:
      return AuthAnswer::kUnknown;
  }
}

bosdyn::api::TimeSyncUpdateRequest toWire(const TimeSyncRequest& request, Time now) {
  bosdyn::api::TimeSyncUpdateRequest wire;
  *wire.mutable_header() = requestHeader(now);
  wire.set_clock_identifier(request.clock_identifier);
  if (request.previous) {
    bosdyn::api::TimeSyncRoundTrip& trip = *wire.mutable_previous_round_trip();
    *trip.mutable_client_tx() = toWire(request.previous->client_tx);
    *trip.mutable_server_rx() = toWire(request.previous->server_rx);
    *trip.mutable_server_tx() = toWire(request.previous->server_tx);
    *trip.mutable_client_rx() = toWire(request.previous->client_rx);
  }
  return wire;
}

TimeSyncReply fromWire(const bosdyn::api::TimeSyncUpdateResponse& response, Time sent, Time received) {
  TimeSyncReply reply;
  reply.status = fromWire(response.state().status());
  reply.clock_identifier = response.clock_identifier();
  if (response.state().has_best_estimate()) {
    const bosdyn::api::TimeSyncEstimate& best = response.state().best_estimate();
    reply.best = ClockEstimate{fromWire(best.clock_skew()), fromWire(best.round_trip_time())};
  }
  reply.exchange = {sent, fromWire(response.header().request_received_timestamp()),
                    fromWire(response.header().response_timestamp()), received};
  return reply;
}

RobotState fromWire(const bosdyn::api::RobotState& state) {
  const bosdyn::api::KinematicState& kinematics = state.kinematic_state();
  RobotState result;
  result.acquired_robot = fromWire(kinematics.acquisition_timestamp());
  for (const auto& [child, edge] : kinematics.transforms_snapshot().child_to_parent_edge_map())
    result.frames[child] = {edge.parent_frame_name(), fromWire(edge.parent_tform_child())};
  if (kinematics.has_velocity_of_body_in_odom())
    result.body_velocity["odom"] = fromWire(kinematics.velocity_of_body_in_odom());
  if (kinematics.has_velocity_of_body_in_vision())
    result.body_velocity["vision"] = fromWire(kinematics.velocity_of_body_in_vision());
  return result;
}

bosdyn::api::Vec3 toWire(const Eigen::Vector3d& v) {
  bosdyn::api::Vec3 wire;
  wire.set_x(v.x());
  wire.set_y(v.y());
  wire.set_z(v.z());
  return wire;
}

bosdyn::api::SE3Pose toWire(const SE3& pose) {
  bosdyn::api::SE3Pose wire;
  *wire.mutable_position() = toWire(pose.translation);
  wire.mutable_rotation()->set_w(pose.rotation.w());
  wire.mutable_rotation()->set_x(pose.rotation.x());
  wire.mutable_rotation()->set_y(pose.rotation.y());
  wire.mutable_rotation()->set_z(pose.rotation.z());
  return wire;
}

}  // namespace sgraphs::wire
