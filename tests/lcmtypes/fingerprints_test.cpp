// The lock file of fingerprints: a message that changes shows up here, and its schema has to be raised.
#include <gtest/gtest.h>

#include <bit>
#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "sgraphs/doorway_t.hpp"
#include "sgraphs/floor_t.hpp"
#include "sgraphs/free_space_cluster_t.hpp"
#include "sgraphs/free_space_t.hpp"
#include "sgraphs/free_space_vertex_t.hpp"
#include "sgraphs/graph_node_t.hpp"
#include "sgraphs/graph_plane_t.hpp"
#include "sgraphs/graph_update_t.hpp"
#include "sgraphs/header_t.hpp"
#include "sgraphs/keyframe_planes_t.hpp"
#include "sgraphs/keyframe_t.hpp"
#include "sgraphs/lidar_points_t.hpp"
#include "sgraphs/loop_closure_t.hpp"
#include "sgraphs/loop_closures_t.hpp"
#include "sgraphs/map_chunk_t.hpp"
#include "sgraphs/map_to_odom_t.hpp"
#include "sgraphs/odometry_t.hpp"
#include "sgraphs/passage_t.hpp"
#include "sgraphs/plane_t.hpp"
#include "sgraphs/pose_t.hpp"
#include "sgraphs/relative_pose_t.hpp"
#include "sgraphs/room_t.hpp"
#include "sgraphs/rooms_t.hpp"
#include "sgraphs/round_schedule_t.hpp"
#include "sgraphs/run_result_t.hpp"
#include "sgraphs/session_t.hpp"
#include "sgraphs/spot_odometry_t.hpp"
#include "sgraphs/status_t.hpp"
#include "sgraphs/stream_end_t.hpp"
#include "sgraphs/transform_t.hpp"
#include "sgraphs/velodyne_packets_t.hpp"

namespace sgraphs {
namespace {

namespace fs = std::filesystem;

template <typename... Message>
std::map<std::string, std::string> fingerprints() {
  const auto hex = [](int64_t hash) {
    char text[17];
    std::snprintf(text, sizeof text, "%016" PRIx64, static_cast<uint64_t>(hash));
    return std::string(text);
  };
  return {{Message::getTypeName(), hex(Message::getHash())}...};
}

std::map<std::string, std::string> built() {
  return fingerprints<doorway_t, floor_t, free_space_cluster_t, free_space_t, free_space_vertex_t,
                      graph_node_t, graph_plane_t, graph_update_t, header_t, keyframe_planes_t, keyframe_t,
                      lidar_points_t, loop_closure_t, loop_closures_t, map_chunk_t, map_to_odom_t, odometry_t,
                      passage_t, plane_t, pose_t, relative_pose_t, room_t, rooms_t, round_schedule_t,
                      run_result_t, session_t, spot_odometry_t, status_t, stream_end_t, transform_t,
                      velodyne_packets_t>();
}

std::map<std::string, std::string> locked() {
  std::ifstream in(fs::path(SGRAPHS_SOURCE_DIR) / "lcmtypes" / "fingerprints.txt");
  std::map<std::string, std::string> lines;
  std::string name, hash;
  while (in >> name >> hash) lines[name] = hash;
  return lines;
}

TEST(FingerprintsTest, EveryTypeHasTheLockedFingerprint) {
  const auto types = built(), file = locked();
  for (const auto& [name, hash] : types) {
    const auto line = file.find(name);
    EXPECT_TRUE(line != file.end() && line->second == hash)
        << "lcmtypes/fingerprints.txt must say '" << name << " " << hash
        << "'; a change to a raw channel's message also raises kMessageSchema";
  }
  EXPECT_EQ(file.size(), types.size());
}

TEST(FingerprintsTest, EveryMessageFileIsLocked) {
  const auto file = locked();
  for (const auto& entry : fs::directory_iterator(fs::path(SGRAPHS_SOURCE_DIR) / "lcmtypes")) {
    if (entry.path().extension() != ".lcm") continue;
    EXPECT_TRUE(file.contains(entry.path().stem().string())) << entry.path().filename();
  }
}

TEST(FingerprintsTest, PoseIsReadByToolsOfTheLcmWorld) {
  // Generated bindings of libbot's pose_t carry this hash of its members; a fingerprint is that, turned left
  // by one bit.
  constexpr uint64_t kMembers = 0x170b77d82958082f;
  EXPECT_EQ(static_cast<uint64_t>(pose_t::getHash()), std::rotl(kMembers, 1));
}

}  // namespace
}  // namespace sgraphs
