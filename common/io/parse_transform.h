#pragma once

#include <string>

#include "common/geometry/se3.h"

namespace sgraphs {

// "x y z qx qy qz qw" (blanks or commas). Throws UsageError that names the option.
SE3 parseTransform(const std::string& text, const std::string& option);

}  // namespace sgraphs
