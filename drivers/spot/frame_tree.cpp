#include "drivers/spot/frame_tree.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sgraphs {
namespace {

constexpr double kMaxNormError = 0.01;

bool isKnown(const FrameTree& tree, const std::string& frame) {
  return tree.count(frame) > 0 ||
         std::any_of(tree.begin(), tree.end(), [&](const auto& edge) { return edge.second.parent == frame; });
}

// The frame and all above it up to a root; an error names the frame.
std::vector<std::string> pathToRoot(const FrameTree& tree, const std::string& frame, std::string& error) {
  std::vector<std::string> path{frame};
  for (auto edge = tree.find(frame); edge != tree.end() && !edge->second.parent.empty();
       edge = tree.find(path.back())) {
    if (path.size() > tree.size()) {
      error = "the parents of frame '" + frame + "' go in a circle";
      break;
    }
    path.push_back(edge->second.parent);
  }
  return path;
}

// T_top_bottom along the first `count` edges of a path, whose first member is the bottom.
std::optional<SE3> climb(const FrameTree& tree, const std::vector<std::string>& path, size_t count,
                         std::string& error) {
  SE3 T_here_bottom;
  for (size_t i = 0; i < count; ++i) {
    SE3 T_parent_child = tree.at(path[i]).T_parent_child;
    const double norm = T_parent_child.rotation.norm();
    if (!T_parent_child.isFinite() || std::abs(norm - 1) > kMaxNormError) {
      error = "the pose of frame '" + path[i] + "' is not finite or its quaternion not of unit length";
      return std::nullopt;
    }
    T_parent_child.rotation.normalize();
    T_here_bottom = T_parent_child * T_here_bottom;
  }
  return T_here_bottom;
}

}  // namespace

FrameLookup findTransform(const FrameTree& tree, const std::string& dst, const std::string& src) {
  FrameLookup result;
  for (const std::string& frame : {dst, src})
    if (!isKnown(tree, frame)) return {std::nullopt, "no frame '" + frame + "'"};
  const std::vector<std::string> from_dst = pathToRoot(tree, dst, result.error);
  const std::vector<std::string> from_src = pathToRoot(tree, src, result.error);
  if (!result.error.empty()) return result;
  const auto meeting = std::find_first_of(from_dst.begin(), from_dst.end(), from_src.begin(), from_src.end());
  if (meeting == from_dst.end())
    return {std::nullopt, "frames '" + dst + "' and '" + src + "' are not connected"};
  const auto dst_edges = static_cast<size_t>(meeting - from_dst.begin());
  const auto src_edges =
      static_cast<size_t>(std::find(from_src.begin(), from_src.end(), *meeting) - from_src.begin());
  const std::optional<SE3> T_top_dst = climb(tree, from_dst, dst_edges, result.error);
  const std::optional<SE3> T_top_src = climb(tree, from_src, src_edges, result.error);
  if (!T_top_dst || !T_top_src) return result;
  const SE3 T_dst_src = T_top_dst->inverse() * *T_top_src;
  if (!T_dst_src.isFinite())
    return {std::nullopt, "the pose of '" + src + "' in '" + dst + "' is not finite"};
  result.T_dst_src = T_dst_src;
  return result;
}

}  // namespace sgraphs
