#include "common/bus/channels.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace sgraphs::channels {
namespace {

constexpr std::array kTable{
    Row{"SESSION", "session_t", "any source", "1 Hz", true},
    Row{"VELODYNE_PACKETS", "velodyne_packets_t", "driver, converter, simulator", "20-40 Hz", true},
    Row{"LIDAR_POINTS", "lidar_points_t", "converter, other drivers", "10 Hz, chunks", true},
    Row{"SPOT_ODOMETRY", "spot_odometry_t", "bridge, converter, simulator", "50 Hz", true},
    Row{"ROUND_SCHEDULE", "round_schedule_t", "sgraphs-backend", "per round", true},
    Row{"STREAM_END", "stream_end_t", "any source", "once", true},
    Row{"POSE_SPOT", "pose_t", "bridge, converter", "50 Hz", false},
    Row{"ODOMETRY", "odometry_t", "sgraphs-odometry", "10 Hz", false},
    Row{"POSE_ODOM", "pose_t", "sgraphs-odometry", "10 Hz", false},
    Row{"KEYFRAME", "keyframe_t", "sgraphs-odometry", "per keyframe, chunks", false},
    Row{"ODOMETRY_END", "stream_end_t", "sgraphs-odometry", "once", false},
    Row{"KEYFRAME_PLANES", "keyframe_planes_t", "sgraphs-planes", "per keyframe", false},
    Row{"PLANES_END", "stream_end_t", "sgraphs-planes", "once", false},
    Row{"FREE_SPACE", "free_space_t", "sgraphs-free-space", "per round, chunks", false},
    Row{"ROOMS", "rooms_t", "sgraphs-rooms", "per round, chunks", false},
    Row{"LOOP_CLOSURES", "loop_closures_t", "sgraphs-loops", "per round, chunks", false},
    Row{"GRAPH_UPDATE", "graph_update_t", "sgraphs-backend", "per round", false},
    Row{"GRAPH_SNAPSHOT", "graph_update_t", "sgraphs-backend", "every 50 rounds", false},
    Row{"MAP_CHUNK", "map_chunk_t", "sgraphs-backend", "per keyframe, chunks", false},
    Row{"MAP_TO_ODOM", "map_to_odom_t", "sgraphs-backend", "per round", false},
    Row{"POSE", "pose_t", "sgraphs-backend", "10 Hz", false},
    Row{"RUN_RESULT", "run_result_t", "sgraphs-backend", "once", false},
    Row{"STATUS_VELODYNE_DRIVER", "status_t", "sgraphs-velodyne-driver", "1 Hz", false},
    Row{"STATUS_ODOMETRY", "status_t", "sgraphs-odometry", "1 Hz", false},
    Row{"STATUS_PLANES", "status_t", "sgraphs-planes", "1 Hz", false},
    Row{"STATUS_FREE_SPACE", "status_t", "sgraphs-free-space", "1 Hz", false},
    Row{"STATUS_ROOMS", "status_t", "sgraphs-rooms", "1 Hz", false},
    Row{"STATUS_LOOPS", "status_t", "sgraphs-loops", "1 Hz", false},
    Row{"STATUS_BACKEND", "status_t", "sgraphs-backend", "1 Hz", false},
    Row{"STATUS_SPOT_BRIDGE", "status_t", "sgraphs-spot-bridge", "1 Hz", false},
};

}  // namespace

std::span<const Row> table() {
  return kTable;
}

const Row* find(const char* name) {
  const auto row = std::find_if(kTable.begin(), kTable.end(),
                                [&](const Row& r) { return std::strcmp(r.name, name) == 0; });
  return row == kTable.end() ? nullptr : &*row;
}

}  // namespace sgraphs::channels
