#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/types/session.h"
#include "drivers/recording/ros/wire_reader.h"

// The three messages of ROS that recordings are converted from; ROS 1 and ROS 2 give them the same members,
// but for the header's `seq`. Views (spans) look into the bytes that the reader was made of. All throw
// WireError.
namespace sgraphs {

inline constexpr char kVelodyneScanType[] = "velodyne_msgs/VelodyneScan";
inline constexpr char kPointCloudType[] = "sensor_msgs/PointCloud2";
inline constexpr char kOdometryType[] = "nav_msgs/Odometry";

// A packet as ROS' Velodyne driver stamped it: when it arrived, or with `gps_time` by the sensor's own clock.
struct RosVelodynePacket {
  Time stamp;
  std::span<const uint8_t> bytes;  // 1206
};
std::vector<RosVelodynePacket> readVelodyneScan(WireReader reader);

// sensor_msgs/PointField.
struct RosPointField {
  // INT8 1, UINT8 2, INT16 3, UINT16 4, INT32 5, UINT32 6, FLOAT32 7, FLOAT64 8.
  static constexpr uint8_t kUint32 = 6, kFloat32 = 7, kFloat64 = 8;
  std::string name;
  uint32_t offset = 0;  // within the point [bytes]
  uint8_t datatype = 0;
};

struct RosPointCloud {
  Time stamp;
  uint32_t height = 0, width = 0;
  std::vector<RosPointField> fields;
  bool is_bigendian = false;
  uint32_t point_step = 0, row_step = 0;  // [bytes]
  std::span<const uint8_t> data;
};
RosPointCloud readPointCloud(WireReader reader);

struct RosOdometry {
  BodyOdometry sample;  // child_frame_id is the body, header.frame_id its odometry frame
  std::string body_frame;
};
// Throws WireError also if the pose is not finite or its quaternion not of unit length.
RosOdometry readOdometry(WireReader reader);

}  // namespace sgraphs
