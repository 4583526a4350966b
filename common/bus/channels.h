#pragma once

#include <span>

#include "common/bus/bus.h"
#include "sgraphs/free_space_t.hpp"
#include "sgraphs/graph_update_t.hpp"
#include "sgraphs/keyframe_planes_t.hpp"
#include "sgraphs/keyframe_t.hpp"
#include "sgraphs/lidar_points_t.hpp"
#include "sgraphs/loop_closures_t.hpp"
#include "sgraphs/map_chunk_t.hpp"
#include "sgraphs/map_to_odom_t.hpp"
#include "sgraphs/odometry_t.hpp"
#include "sgraphs/pose_t.hpp"
#include "sgraphs/rooms_t.hpp"
#include "sgraphs/round_schedule_t.hpp"
#include "sgraphs/run_result_t.hpp"
#include "sgraphs/session_t.hpp"
#include "sgraphs/spot_odometry_t.hpp"
#include "sgraphs/status_t.hpp"
#include "sgraphs/stream_end_t.hpp"
#include "sgraphs/velodyne_packets_t.hpp"

namespace sgraphs::channels {

// Raw channels: with these a log is complete by itself; all others are derived from them.
inline constexpr Channel<session_t> kSession{"SESSION"};
inline constexpr Channel<velodyne_packets_t> kVelodynePackets{"VELODYNE_PACKETS"};
inline constexpr Channel<lidar_points_t> kLidarPoints{"LIDAR_POINTS"};
inline constexpr Channel<spot_odometry_t> kSpotOdometry{"SPOT_ODOMETRY"};
inline constexpr Channel<round_schedule_t> kRoundSchedule{"ROUND_SCHEDULE"};
inline constexpr Channel<stream_end_t> kStreamEnd{"STREAM_END"};

// Derived channels.
inline constexpr Channel<odometry_t> kOdometry{"ODOMETRY"};
inline constexpr Channel<pose_t> kPoseSpot{"POSE_SPOT"};
inline constexpr Channel<pose_t> kPoseOdom{"POSE_ODOM"};
inline constexpr Channel<keyframe_t> kKeyframe{"KEYFRAME"};
inline constexpr Channel<keyframe_planes_t> kKeyframePlanes{"KEYFRAME_PLANES"};
inline constexpr Channel<stream_end_t> kOdometryEnd{"ODOMETRY_END"};
inline constexpr Channel<stream_end_t> kPlanesEnd{"PLANES_END"};
inline constexpr Channel<free_space_t> kFreeSpace{"FREE_SPACE"};
inline constexpr Channel<rooms_t> kRooms{"ROOMS"};
inline constexpr Channel<loop_closures_t> kLoopClosures{"LOOP_CLOSURES"};
inline constexpr Channel<graph_update_t> kGraphUpdate{"GRAPH_UPDATE"};
inline constexpr Channel<graph_update_t> kGraphSnapshot{"GRAPH_SNAPSHOT"};
inline constexpr Channel<map_chunk_t> kMapChunk{"MAP_CHUNK"};
inline constexpr Channel<map_to_odom_t> kMapToOdom{"MAP_TO_ODOM"};
inline constexpr Channel<pose_t> kPose{"POSE"};
inline constexpr Channel<run_result_t> kRunResult{"RUN_RESULT"};
inline constexpr Channel<status_t> kStatusVelodyneDriver{"STATUS_VELODYNE_DRIVER"};
inline constexpr Channel<status_t> kStatusOdometry{"STATUS_ODOMETRY"};
inline constexpr Channel<status_t> kStatusPlanes{"STATUS_PLANES"};
inline constexpr Channel<status_t> kStatusFreeSpace{"STATUS_FREE_SPACE"};
inline constexpr Channel<status_t> kStatusRooms{"STATUS_ROOMS"};
inline constexpr Channel<status_t> kStatusLoops{"STATUS_LOOPS"};
inline constexpr Channel<status_t> kStatusBackend{"STATUS_BACKEND"};
inline constexpr Channel<status_t> kStatusSpotBridge{"STATUS_SPOT_BRIDGE"};

// One row per channel: the README shows this table and a test compares the two.
struct Row {
  const char* name;
  const char* type;
  const char* writer;
  const char* rate;
  bool raw;  // belongs to the raw channels of a log
};

// Every channel, in the order of the README. Queues are unbounded on every subscription (LCM would drop the
// newest message of a full one); what is lost on the wire is found by `seq`, counted, and ends a run as not
// reproducible.
std::span<const Row> table();

// Row of a channel; nullptr if the name is not ours.
const Row* find(const char* name);

}  // namespace sgraphs::channels
