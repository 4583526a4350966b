#include "common/io/tum.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "common/base/error.h"

namespace sgraphs {
bool parseSeconds(const std::string& text, Time& time) {
  const size_t dot = text.find('.');
  const std::string whole = text.substr(0, dot);
  std::string fraction = dot == std::string::npos ? "" : text.substr(dot + 1);
  const auto digits = [](const std::string& s) {
    return s.find_first_not_of("0123456789") == std::string::npos;
  };
  if (whole.empty() || whole.size() > 12 || !digits(whole) || !digits(fraction)) {
    // Scientific notation (KITTI) and signs go the ordinary way.
    char* end = nullptr;
    const double seconds = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || *end != '\0' || !std::isfinite(seconds) || std::abs(seconds) > 9e12)
      return false;
    time.us = std::llround(seconds * 1e6);
    return true;
  }
  fraction.resize(7, '0');
  time.us = std::stoll(whole) * 1000000 + (std::stoll(fraction) + 5) / 10;
  return true;
}

std::vector<StampedPose> readTum(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw Error("cannot read trajectory '" + path + "': check the path");
  std::vector<StampedPose> poses;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line[0] == '#' || line == "\r") continue;
    std::istringstream row(line);
    std::string stamp;
    double v[7];
    row >> stamp;
    for (double& x : v) row >> x;
    StampedPose pose;
    const auto where = path + ":" + std::to_string(number) + ": ";
    if (!row || !parseSeconds(stamp, pose.time)) throw Error(where + "not a TUM row 't x y z qx qy qz qw'");
    const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
    pose.pose = {q.normalized(), {v[0], v[1], v[2]}};
    if (!pose.pose.isFinite() || std::abs(q.norm() - 1.0) > 0.01)
      throw Error(where + "not a finite pose with a unit quaternion");
    if (!poses.empty() && pose.time < poses.back().time)
      throw Error(where + "time runs backwards: sort the file by its first column");
    poses.push_back(pose);
  }
  if (poses.empty()) throw Error("trajectory '" + path + "' holds no pose");
  return poses;
}

void writeTum(const std::string& path, const std::vector<StampedPose>& poses) {
  std::FILE* out = std::fopen(path.c_str(), "w");
  if (!out) throw Error("cannot write '" + path + "': check the folder and its permissions");
  for (const auto& [time, T] : poses)
    std::fprintf(out, "%lld.%06lld %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
                 static_cast<long long>(time.us / 1000000), static_cast<long long>(time.us % 1000000),
                 T.translation.x(), T.translation.y(), T.translation.z(), T.rotation.x(), T.rotation.y(),
                 T.rotation.z(), T.rotation.w());
  if (std::fclose(out) != 0) throw Error("cannot write '" + path + "': is the disk full?");
}

}  // namespace sgraphs
