#pragma once

#include "drivers/spot/body_state.h"
#include "drivers/spot/time_sync.h"
#include "drivers/spot/token_keeper.h"
#include "spot_wire.pb.h"

// Wire messages become the types of the cores and back.
namespace sgraphs::wire {

// Rounded down to microseconds.
Time fromWire(const google::protobuf::Timestamp& stamp);
Duration fromWire(const google::protobuf::Duration& duration);
google::protobuf::Timestamp toWire(Time time);
google::protobuf::Duration toWire(Duration duration);

bosdyn::api::RequestHeader requestHeader(Time now);

AuthAnswer fromWire(bosdyn::api::GetAuthTokenResponse::Status status);

bosdyn::api::TimeSyncUpdateRequest toWire(const TimeSyncRequest& request, Time now);
// sent and received: host times of the call.
TimeSyncReply fromWire(const bosdyn::api::TimeSyncUpdateResponse& response, Time sent, Time received);

RobotState fromWire(const bosdyn::api::RobotState& state);
bosdyn::api::SE3Pose toWire(const SE3& pose);
bosdyn::api::Vec3 toWire(const Eigen::Vector3d& v);

}  // namespace sgraphs::wire
