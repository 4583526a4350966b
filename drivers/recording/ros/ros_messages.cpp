#include "drivers/recording/ros/ros_messages.h"

#include <cmath>

namespace sgraphs {
namespace {

constexpr size_t kPacketBytes = 1206;

Time readStamp(WireReader& reader) {
  const auto seconds = reader.read<int32_t>();
  const auto nanoseconds = reader.read<uint32_t>();
  return Time{int64_t{seconds} * 1'000'000 + (nanoseconds + 500) / 1000};
}

// std_msgs/Header; ROS 2 has no `seq`.
Time readHeader(WireReader& reader) {
  if (!reader.isCdr()) reader.read<uint32_t>();
  const Time stamp = readStamp(reader);
  reader.readString();
  return stamp;
}

}  // namespace

std::vector<RosVelodynePacket> readVelodyneScan(WireReader reader) {
  readHeader(reader);
  std::vector<RosVelodynePacket> packets(reader.readCount(kPacketBytes));
  for (RosVelodynePacket& packet : packets) {
    packet.stamp = readStamp(reader);
    packet.bytes = reader.readBytes(kPacketBytes);
  }
  return packets;
}

RosPointCloud readPointCloud(WireReader reader) {
  RosPointCloud cloud;
  cloud.stamp = readHeader(reader);
  cloud.height = reader.read<uint32_t>();
  cloud.width = reader.read<uint32_t>();
  constexpr size_t kLeastFieldBytes = 13;  // an empty name
  cloud.fields.resize(reader.readCount(kLeastFieldBytes));
  for (RosPointField& field : cloud.fields) {
    field.name = reader.readString();
    field.offset = reader.read<uint32_t>();
    field.datatype = reader.read<uint8_t>();
    reader.read<uint32_t>();  // count: the members wanted here are single values
  }
  cloud.is_bigendian = reader.read<uint8_t>() != 0;
  cloud.point_step = reader.read<uint32_t>();
  cloud.row_step = reader.read<uint32_t>();
  cloud.data = reader.readBytes(reader.readCount(1));
  return cloud;
}

RosOdometry readOdometry(WireReader reader) {
  RosOdometry odometry;
  odometry.sample.time = readHeader(reader);
  odometry.body_frame = reader.readString();
  double v[7];
  for (double& value : v) value = reader.read<double>();
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!(std::abs(q.norm() - 1.0) < 1e-3)) throw WireError("its quaternion is not of unit length");
  odometry.sample.T_odom_body = SE3(q.normalized(), {v[0], v[1], v[2]});
  if (!odometry.sample.T_odom_body.isFinite()) throw WireError("its pose is not finite");
  for (int i = 0; i < 36; ++i) reader.read<double>();  // covariance of the pose
  Vector6d twist_body;
  for (double& value : twist_body) value = reader.read<double>();
  if (twist_body.allFinite()) odometry.sample.twist_body = twist_body;
  return odometry;
}

}  // namespace sgraphs
