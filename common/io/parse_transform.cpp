#include "common/io/parse_transform.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/base/error.h"

namespace sgraphs {

SE3 parseTransform(const std::string& text, const std::string& option) {
  std::string blanks = text;
  std::replace(blanks.begin(), blanks.end(), ',', ' ');
  std::istringstream in(blanks);
  double v[7];
  for (double& value : v) in >> value;
  std::string rest;
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!in || in >> rest)
    throw UsageError(option + " '" + text + "': give seven numbers \"x y z qx qy qz qw\"");
  SE3 T(q.normalized(), {v[0], v[1], v[2]});
  if (!T.isFinite() || std::abs(q.norm() - 1.0) > 1e-3)
    throw UsageError(option + " '" + text + "': qx qy qz qw must be a unit quaternion");
  return T;
}

}  // namespace sgraphs
