#pragma once

#include <span>
#include <string_view>

namespace sgraphs {

// The .lcm files of lcmtypes/, put into the program when it was built.
std::span<const std::string_view> lcmTexts();

}  // namespace sgraphs
