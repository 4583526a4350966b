#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/io/tum.h"
#include "common/types/keyframe.h"
#include "common/types/lidar_scan.h"
#include "common/types/plane.h"
#include "common/types/session.h"
#include "common/types/velodyne_packet.h"
#include "sgraphs/graph_plane_t.hpp"
#include "sgraphs/keyframe_planes_t.hpp"
#include "sgraphs/keyframe_t.hpp"
#include "sgraphs/lidar_points_t.hpp"
#include "sgraphs/map_chunk_t.hpp"
#include "sgraphs/odometry_t.hpp"
#include "sgraphs/pose_t.hpp"
#include "sgraphs/relative_pose_t.hpp"
#include "sgraphs/session_t.hpp"
#include "sgraphs/spot_odometry_t.hpp"
#include "sgraphs/transform_t.hpp"
#include "sgraphs/velodyne_packets_t.hpp"

// The one place where messages become domain types and back. Every message is value-initialised before it is
// filled. toMessage leaves the header's session, boot and seq to the publisher and fills utime; fromMessage
// returns nothing for content that cannot be right (not finite, counts that disagree, no unit quaternion):
// the caller counts it.
namespace sgraphs {

// Most bytes of a chunked message's bulk, so that a message stays one datagram of at most 60 kB.
inline constexpr int kMaxChunkBytes = 48000;
// Coordinates of clouds are 16-bit multiples of this, or of more where a point lies too far off for that.
inline constexpr double kCloudResolution_m = 0.002;  // the VLP-16's own range step
inline constexpr double kMaxCloudUnits = 32767;
inline constexpr int kMaxVelodynePackets = 40;
inline constexpr int32_t kMessageSchema = 1;

transform_t toMessage(const SE3& T);
std::optional<SE3> fromMessage(const transform_t& message);

session_t toMessage(const Session& session, Time now);
std::optional<Session> fromMessage(const session_t& message);

relative_pose_t toMessage(const RelativePose& relative_pose);
std::optional<RelativePose> fromMessage(const relative_pose_t& message);

spot_odometry_t toMessage(const BodyOdometry& odometry);
std::optional<BodyOdometry> fromMessage(const spot_odometry_t& message);

odometry_t toMessage(const OdometryEstimate& estimate);
std::optional<OdometryEstimate> fromMessage(const odometry_t& message);

// Pose of body in map or odom with the velocity of body.
pose_t toPoseMessage(Time time, const SE3& T_world_body, const Vector6d& twist_body);

velodyne_packets_t toMessage(std::span<const VelodynePacket> packets, int64_t revolution, int32_t part,
                             bool last_part);
std::optional<std::vector<VelodynePacket>> fromMessage(const velodyne_packets_t& message);

// Chunks of a sweep, and the sweep from all its chunks in order.
std::vector<lidar_points_t> toMessages(const LidarScan& scan);
std::optional<LidarScan> fromMessages(std::span<const lidar_points_t> chunks);

// Chunks of a keyframe, and the keyframe from those of its chunks that arrived (at least one): points of lost
// chunks are missing, all else is repeated in each. Coordinates are quantised to 2 mm, or coarser beyond 65
// m.
std::vector<keyframe_t> toMessages(const Keyframe& keyframe);
std::optional<Keyframe> fromMessages(std::span<const keyframe_t> chunks);

// A keyframe's part of the metric map: the first point of each voxel of 0.1 m, quantised to 2 mm, or coarser
// beyond 65 m. A keyframe without points gives one message without points.
std::vector<map_chunk_t> mapChunks(const Keyframe& keyframe);
// Points of one of them, in the keyframe's body [m].
std::optional<std::vector<Eigen::Vector3f>> pointsOf(const map_chunk_t& message);

// Most planes of a keyframe and corners of a boundary, so that the message stays one datagram.
inline constexpr int kMaxPlanesPerKeyframe = 64;
inline constexpr int kMaxBoundaryCorners = 48;
// Throws std::logic_error for more planes or corners than that.
keyframe_planes_t toMessage(const KeyframePlanes& planes);
std::optional<KeyframePlanes> fromMessage(const keyframe_planes_t& message);

// Most corners of a mapped plane's extent. A merged plane's message carries its two ids and zeros.
inline constexpr int kMaxMapPlaneCorners = 1024;
// Throws std::logic_error for more corners than that.
graph_plane_t toMessage(const MapPlane& plane);
std::optional<MapPlane> fromMessage(const graph_plane_t& message);

}  // namespace sgraphs
