#pragma once

#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/se3.h"

namespace sgraphs {

// A pose with its instant; which frames it relates is said by whoever holds it.
struct StampedPose {
  Time time;
  SE3 pose;
};

// "1700000000.123456789" to microseconds, rounded to nearest, digit by digit; false if it is no plain number.
bool parseSeconds(const std::string& text, Time& time);

// TUM trajectory: `t x y z qx qy qz qw` per line, t in seconds, '#' comments. Stamps are parsed digit by
// digit, so that no microsecond is lost in a double. Throws Error naming file and line for a bad row or time
// running backwards.
std::vector<StampedPose> readTum(const std::string& path);

// t with 6 decimals, the rest with 9. Throws Error if the file cannot be written.
void writeTum(const std::string& path, const std::vector<StampedPose>& poses);

}  // namespace sgraphs
