#include "drivers/recording/ros/sweep_from_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "common/base/error.h"

namespace sgraphs {
namespace {

constexpr std::array<size_t, 9> kDatatypeBytes{0, 1, 1, 2, 2, 4, 4, 4, 8};
constexpr std::array<const char*, 4> kTimeNames{"time", "t", "timestamp", "offset_time"};
constexpr uint8_t kMaxRing = 255;

// One value per point.
class Field {
 public:
  Field(const RosPointField& field, const RosPointCloud& cloud)
      : field_(field), swap_(cloud.is_bigendian), bytes_(bytesOf(field)) {
    if (bytes_ == 0)
      throw Error("field '" + field.name + "' of the point cloud is of unknown datatype " +
                  std::to_string(field.datatype));
    if (uint64_t{field.offset} + bytes_ > cloud.point_step) throw WireError("a field lies outside its point");
  }
  bool wholeNumbers() const { return field_.datatype < RosPointField::kFloat32; }
  double of(const uint8_t* point) const {
    std::array<uint8_t, 8> raw{};
    for (size_t i = 0; i < bytes_; ++i) raw[swap_ ? bytes_ - 1 - i : i] = point[field_.offset + i];
    switch (field_.datatype) {
      case 1:
        return as<int8_t>(raw);
      case 2:
        return as<uint8_t>(raw);
      case 3:
        return as<int16_t>(raw);
      case 4:
        return as<uint16_t>(raw);
      case 5:
        return as<int32_t>(raw);
      case 6:
        return as<uint32_t>(raw);
      case 7:
        return static_cast<double>(as<float>(raw));
      default:
        return as<double>(raw);
    }
  }

 private:
  static size_t bytesOf(const RosPointField& field) {
    return field.datatype < kDatatypeBytes.size() ? kDatatypeBytes[field.datatype] : 0;
  }
  template <typename T>
  static T as(const std::array<uint8_t, 8>& raw) {
    T value;
    std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }
  RosPointField field_;
  bool swap_;
  size_t bytes_;
};

std::optional<Field> find(const RosPointCloud& cloud, const std::string& name) {
  for (const RosPointField& field : cloud.fields)
    if (field.name == name) return Field(field, cloud);
  return std::nullopt;
}

Field coordinate(const RosPointCloud& cloud, const std::string& name) {
  const std::optional<Field> field = find(cloud, name);
  if (!field || field->wholeNumbers())
    throw Error("the point cloud has no field '" + name + "' of float32 or float64");
  return *field;
}

void requireWhole(const RosPointCloud& cloud) {
  const uint64_t row = uint64_t{cloud.width} * cloud.point_step;
  const bool whole =
      cloud.height <= 1
          ? row <= cloud.data.size()
          : cloud.row_step >= row && uint64_t{cloud.height - 1} * cloud.row_step + row <= cloud.data.size();
  if (!whole) throw WireError("the cloud's data are shorter than its size says");
}

struct TimedPoint {
  LidarPoint point;
  double time = 0;  // as the field says
};

// The fields of a cloud that a sweep is made of.
struct Fields {
  std::array<Field, 3> axes;
  std::optional<Field> ring, time;

  // Nothing for a point that is no return.
  std::optional<TimedPoint> read(const uint8_t* bytes) const {
    TimedPoint p;
    for (size_t a = 0; a < 3; ++a)
      p.point.position_lidar[static_cast<int>(a)] = static_cast<float>(axes[a].of(bytes));
    if (!p.point.position_lidar.allFinite() || p.point.position_lidar.isZero(0)) return std::nullopt;
    if (time) p.time = time->of(bytes);
    if (!std::isfinite(p.time)) return std::nullopt;
    const double number = ring ? ring->of(bytes) : 0;
    if (!(number >= 0 && number <= kMaxRing))
      throw Error("field 'ring' of the point cloud holds " + std::to_string(number) + ": 0 to 255 is meant");
    p.point.ring = static_cast<uint8_t>(number);
    return p;
  }
};

std::vector<TimedPoint> readPoints(const RosPointCloud& cloud, const Fields& fields) {
  std::vector<TimedPoint> points;
  for (uint32_t r = 0; r < cloud.height; ++r)
    for (uint32_t c = 0; c < cloud.width; ++c) {
      const size_t at = size_t{r} * cloud.row_step + size_t{c} * cloud.point_step;
      if (const auto point = fields.read(&cloud.data[at])) points.push_back(*point);
    }
  return points;
}

}  // namespace

void SweepFromCloud::learnUnit(bool whole_numbers, double least, double greatest) {
  constexpr double kLongest_s = 10;
  const double span = greatest - least;
  if (span <= 0) return;
  if (!whole_numbers && span <= kLongest_s)
    unit_ = Unit::kSeconds;
  else if (span >= 1e6 && span <= kLongest_s * 1e9)
    unit_ = Unit::kNanoseconds;
  else
    throw Error("field '" + time_field_ + "' of the point cloud spans " + std::to_string(span) +
                " over a sweep: neither seconds nor nanoseconds");
}

void SweepFromCloud::setTimes(std::span<const double> times, bool whole_numbers, LidarScan& scan) {
  const auto [least, greatest] = std::minmax_element(times.begin(), times.end());
  if (!unit_) learnUnit(whole_numbers, *least, *greatest);
  // Without a span nothing but the magnitude can tell.
  const bool nanoseconds = unit_ ? *unit_ == Unit::kNanoseconds : *greatest > 1e17;
  const double to_us = nanoseconds ? 1e-3 : 1e6;
  // A time since the epoch lies beyond 1973; one within a sweep is seconds at most.
  const bool absolute = *greatest * to_us > 1e14;
  const Time base = absolute ? Time{} : scan.end;
  const auto timeOf = [&](double time) { return base + Duration{std::llround(time * to_us)}; };
  scan.begin = timeOf(*least);
  scan.end = timeOf(*greatest);
  for (size_t i = 0; i < times.size(); ++i)
    scan.points[i].time_us = static_cast<int32_t>((timeOf(times[i]) - scan.end).us);
}

LidarScan SweepFromCloud::step(const RosPointCloud& cloud) {
  requireWhole(cloud);
  Fields fields{
      {coordinate(cloud, "x"), coordinate(cloud, "y"), coordinate(cloud, "z")}, find(cloud, "ring"), {}};
  time_field_.clear();
  for (const char* name : kTimeNames)
    if (!fields.time && (fields.time = find(cloud, name))) time_field_ = name;

  LidarScan scan;
  scan.begin = scan.end = cloud.stamp;
  scan.deskewed = !fields.time;
  std::vector<double> times;
  for (const TimedPoint& p : readPoints(cloud, fields)) {
    scan.points.push_back(p.point);
    times.push_back(p.time);
    if (fields.ring) scan.num_rings = std::max<uint16_t>(scan.num_rings, uint16_t{p.point.ring} + 1);
  }
  if (fields.time && !times.empty()) setTimes(times, fields.time->wholeNumbers(), scan);
  return scan;
}

}  // namespace sgraphs
