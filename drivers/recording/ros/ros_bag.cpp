#include "drivers/recording/ros/ros_bag.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>

#include "common/base/error.h"

namespace sgraphs {

std::optional<std::string> complaintAbout(const std::string& path, RecordingKind expected) {
  using namespace std::string_view_literals;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error("cannot read bag '" + path + "': " + std::strerror(errno));
  std::array<char, 16> buffer{};
  in.read(buffer.data(), buffer.size());
  const std::string_view head(buffer.data(), static_cast<size_t>(in.gcount()));
  if (head.empty()) throw Error("bag '" + path + "' is empty: record or copy it again");
  const auto beginsWith = [&](std::string_view magic) { return head.substr(0, magic.size()) == magic; };
  if (beginsWith("\x89MCAP"sv))
    return "'" + path + "' is an MCAP file, which is not read: turn it into .db3 with `ros2 bag convert`, " +
           "storage_id sqlite3";
  if (beginsWith("\x28\xB5\x2F\xFD"sv))
    return "'" + path + "' is compressed with zstd, which is not read: `zstd -d` gives the .db3 file";
  if (beginsWith("#ROSBAG"sv) && expected != RecordingKind::kRos1Bag)
    return "'" + path + "' is a bag of ROS 1: give it with --bag";
  if (beginsWith("SQLite format 3"sv) && expected != RecordingKind::kSqlite)
    return "'" + path + "' is a bag of ROS 2: give it with --db3";
  return std::nullopt;
}

}  // namespace sgraphs
