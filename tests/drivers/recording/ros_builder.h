#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "common/geometry/se3.h"

namespace sgraphs::test {

// How a message is written; see WireReader.
enum class Wire { kRos1, kCdrLittle, kCdrBig };

// Writes the members of a ROS message one after the other, apart from the reader under test.
class WireWriter {
 public:
  explicit WireWriter(Wire wire) : wire_(wire) {
    if (wire != Wire::kRos1) bytes = {0, static_cast<uint8_t>(wire == Wire::kCdrLittle), 0, 0};
  }

  template <typename T>
  WireWriter& put(T value) {
    if (wire_ != Wire::kRos1)
      while ((bytes.size() - 4) % sizeof(T) != 0) bytes.push_back(0);
    uint8_t raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    for (size_t i = 0; i < sizeof(T); ++i)
      bytes.push_back(raw[wire_ == Wire::kCdrBig ? sizeof(T) - 1 - i : i]);
    return *this;
  }
  WireWriter& text(const std::string& value) {
    put(static_cast<uint32_t>(value.size() + (wire_ != Wire::kRos1)));
    bytes.insert(bytes.end(), value.begin(), value.end());
    if (wire_ != Wire::kRos1) bytes.push_back(0);
    return *this;
  }
  WireWriter& raw(const uint8_t* data, size_t size) {
    bytes.insert(bytes.end(), data, data + size);
    return *this;
  }
  WireWriter& stamp(int64_t time_us) {
    put(static_cast<int32_t>(time_us / 1'000'000));
    return put(static_cast<uint32_t>(time_us % 1'000'000 * 1000));
  }
  WireWriter& header(int64_t time_us, const std::string& frame) {
    if (wire_ == Wire::kRos1) put(uint32_t{7});
    return stamp(time_us).text(frame);
  }

  std::vector<uint8_t> bytes;

 private:
  Wire wire_;
};

inline std::vector<uint8_t> odometryMessage(Wire wire, int64_t time_us, const SE3& T_odom_body) {
  WireWriter w(wire);
  w.header(time_us, "odom").text("base_link");
  for (int i = 0; i < 3; ++i) w.put(T_odom_body.translation[i]);
  for (int i = 0; i < 4; ++i) w.put(T_odom_body.rotation.coeffs()[i]);
  for (int i = 0; i < 36; ++i) w.put(1e3 + i);  // covariance
  for (int i = 0; i < 6; ++i) w.put(0.25 * i);  // twist
  for (int i = 0; i < 36; ++i) w.put(2e3 + i);
  return w.bytes;
}

struct StampedPacket {
  int64_t stamp_us;
  std::vector<uint8_t> bytes;
};

inline std::vector<uint8_t> velodyneScanMessage(Wire wire, const std::vector<StampedPacket>& packets) {
  WireWriter w(wire);
  w.header(packets.empty() ? 0 : packets.back().stamp_us, "velodyne")
      .put(static_cast<uint32_t>(packets.size()));
  for (const StampedPacket& packet : packets)
    w.stamp(packet.stamp_us).raw(packet.bytes.data(), packet.bytes.size());
  return w.bytes;
}

// sensor_msgs/PointCloud2: fields and their values are laid down by the test.
struct CloudBuilder {
  struct Field {
    std::string name;
    uint32_t offset;
    uint8_t datatype;
  };
  int64_t stamp_us = 0;
  uint32_t height = 1, width = 0;
  std::vector<Field> fields;
  bool big = false;
  uint32_t point_step = 0, row_step = 0;
  std::vector<uint8_t> data;

  template <typename T>
  void set(size_t at, T value) {
    uint8_t raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    for (size_t i = 0; i < sizeof(T); ++i) data.at(at + i) = raw[big ? sizeof(T) - 1 - i : i];
  }
  std::vector<uint8_t> message(Wire wire) const {
    WireWriter w(wire);
    w.header(stamp_us, "lidar").put(height).put(width).put(static_cast<uint32_t>(fields.size()));
    for (const Field& field : fields)
      w.text(field.name).put(field.offset).put(field.datatype).put(uint32_t{1});
    w.put(static_cast<uint8_t>(big)).put(point_step).put(row_step).put(static_cast<uint32_t>(data.size()));
    w.raw(data.data(), data.size()).put(uint8_t{1});
    return w.bytes;
  }
};

}  // namespace sgraphs::test
