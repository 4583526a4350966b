#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/geometry/se3.h"

namespace sgraphs {

// A frame hangs on its parent; an empty parent marks a root. Roots may also be named as a parent only.
struct FrameEdge {
  std::string parent;
  SE3 T_parent_child;
};
using FrameTree = std::map<std::string, FrameEdge>;  // by the child's name

// T_dst_src, or why there is none: one line that names the frame.
struct FrameLookup {
  std::optional<SE3> T_dst_src;
  std::string error;
};

// Walks from both frames up to where they meet: whichever of the two is above the other, wherever the root
// is. Refused: frames that are absent or not connected, parents in a circle, and on the way poses that are
// not finite or whose quaternion is not of unit length (to 1 %; it is normalised).
FrameLookup findTransform(const FrameTree& tree, const std::string& dst, const std::string& src);

}  // namespace sgraphs
