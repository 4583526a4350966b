#include "drivers/recording/scan_folder.h"

#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/base/error.h"
#include "common/io/tum.h"

namespace sgraphs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kKittiPointBytes = 16;

std::vector<Eigen::Vector3f> readKittiBin(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error("cannot read scan '" + path + "': check its permissions");
  const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (bytes.size() % kKittiPointBytes != 0)
    throw Error("scan '" + path + "' has " + std::to_string(bytes.size()) +
                " bytes, no multiple of 16 (float32 x y z intensity)");
  std::vector<Eigen::Vector3f> points(bytes.size() / kKittiPointBytes);
  for (size_t i = 0; i < points.size(); ++i)
    std::memcpy(points[i].data(), &bytes[kKittiPointBytes * i], 3 * sizeof(float));
  return points;
}

// PCL's reader trusts the header: a file that is no PCD, or shorter than its header says, would make it read
// where nothing is. Returns whether the body may be read.
bool soundPcd(const std::string& path) {
  pcl::PCDReader reader;
  pcl::PCLPointCloud2 header;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0, data_type = -1;
  unsigned int body = 0;
  if (reader.readHeader(path, header, origin, orientation, version, data_type, body) < 0) return false;
  if (header.fields.empty() || header.point_step == 0) return false;
  const uint64_t points = static_cast<uint64_t>(header.width) * header.height;
  const uint64_t file_bytes = fs::file_size(path);
  constexpr int kAscii = 0, kBinary = 1;
  if (data_type == kBinary) return body + points * header.point_step <= file_bytes;
  // In text, a value takes a byte at least; compressed data begin with their two sizes.
  if (data_type == kAscii) return body + points * header.fields.size() <= file_bytes;
  std::ifstream in(path, std::ios::binary);
  uint32_t compressed = 0, uncompressed = 0;
  in.seekg(body);
  in.read(reinterpret_cast<char*>(&compressed), sizeof compressed);
  in.read(reinterpret_cast<char*>(&uncompressed), sizeof uncompressed);
  return in && body + 8 + uint64_t{compressed} <= file_bytes && uncompressed == points * header.point_step;
}

// Offset of a float32 or float64 coordinate within a point, and its type.
const pcl::PCLPointField& coordinate(const pcl::PCLPointCloud2& cloud, const std::string& name,
                                     const std::string& path) {
  for (const pcl::PCLPointField& field : cloud.fields)
    if (field.name == name &&
        (field.datatype == pcl::PCLPointField::FLOAT32 || field.datatype == pcl::PCLPointField::FLOAT64))
      return field;
  throw Error("scan '" + path + "' has no coordinate '" + name + "' as float or double");
}

std::vector<Eigen::Vector3f> pointsOf(const pcl::PCLPointCloud2& cloud, const std::string& path) {
  const size_t count = static_cast<size_t>(cloud.width) * cloud.height;
  std::vector<Eigen::Vector3f> points(count);
  const char* const names[3] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    const pcl::PCLPointField& field = coordinate(cloud, names[axis], path);
    const bool is_double = field.datatype == pcl::PCLPointField::FLOAT64;
    for (size_t i = 0; i < count; ++i) {
      const size_t at = i * cloud.point_step + field.offset;
      if (at + (is_double ? 8 : 4) > cloud.data.size())
        throw Error("scan '" + path + "' is shorter than its header says");
      double value = 0;
      if (is_double) {
        std::memcpy(&value, &cloud.data[at], 8);
      } else {
        float single = 0;
        std::memcpy(&single, &cloud.data[at], 4);
        value = single;
      }
      points[i][axis] = static_cast<float>(value);
    }
  }
  return points;
}

std::string extensionOf(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool isScan(const fs::path& path) {
  const std::string extension = extensionOf(path);
  return extension == ".pcd" || extension == ".ply" || extension == ".bin";
}

}  // namespace

std::vector<Eigen::Vector3f> readPoints(const std::string& path) {
  const std::string extension = extensionOf(path);
  if (extension == ".bin") return readKittiBin(path);
  // Its own complaints would stand beside our one line.
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  pcl::PCLPointCloud2 cloud;
  int status = -1;
  try {
    if (extension == ".ply")
      status = pcl::io::loadPLYFile(path, cloud);
    else if (soundPcd(path))
      status = pcl::io::loadPCDFile(path, cloud);
  } catch (const std::exception&) {
    status = -1;
  }
  if (status < 0)
    throw Error("cannot read scan '" + path + "': not a whole " + extension.substr(1) + " file");
  return pointsOf(cloud, path);
}

ScanFolder::ScanFolder(const std::string& path) : path_(path) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path, error))
    if (entry.is_regular_file() && isScan(entry.path())) files_.push_back(entry.path().string());
  if (error) throw Error("cannot read folder '" + path + "': " + error.message());
  if (files_.empty()) throw Error("folder '" + path + "' holds no scan: .pcd, .ply or KITTI .bin files");
  std::sort(files_.begin(), files_.end());
  readTimes();
  if (times_.size() != files_.size())
    throw Error("'" + timesFile() + "' has " + std::to_string(times_.size()) + " times for " +
                std::to_string(files_.size()) + " scans: one per file, in order of their names");
}

std::string ScanFolder::timesFile() const {
  return (fs::path(path_) / "times.txt").string();
}

void ScanFolder::readTimes() {
  std::ifstream in(timesFile());
  if (!in)
    throw Error("cannot read '" + timesFile() + "': it must give the time [s] of each scan, one per line");
  std::string text;
  while (in >> text) {
    Time time;
    const std::string where =
        timesFile() + ", time " + std::to_string(times_.size() + 1) + " ('" + text + "'): ";
    if (!parseSeconds(text, time)) throw Error(where + "not a number of seconds");
    if (!times_.empty() && time <= times_.back()) throw Error(where + "not later than the one before");
    times_.push_back(time);
  }
}

std::optional<LidarScan> ScanFolder::next() {
  if (next_ == files_.size()) return std::nullopt;
  LidarScan scan;
  scan.begin = scan.end = times_[next_];
  scan.sequence = static_cast<int64_t>(next_);
  scan.deskewed = true;
  for (const Eigen::Vector3f& position : readPoints(files_[next_])) {
    if (!position.allFinite()) continue;
    LidarPoint point;
    point.position_lidar = position;
    scan.points.push_back(point);
  }
  ++next_;
  return scan;
}

}  // namespace sgraphs
