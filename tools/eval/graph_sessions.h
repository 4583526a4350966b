#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>

namespace sgraphs {

// Number of the session that a keyframe or a room of graph.json is of; 0 where the file tells none.
inline int sessionOf(const nlohmann::json& node) {
  return node.value("session", 0);
}

// The newest one of a graph: a recording's truth says nothing of earlier ones, whose walks and clocks are
// their own.
inline int lastSession(const nlohmann::json& graph) {
  int last = 0;
  for (const auto& node : graph.at("nodes")) last = std::max(last, sessionOf(node));
  return last;
}

}  // namespace sgraphs
