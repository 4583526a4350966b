#pragma once

#include <array>
#include <vector>

#include "backend/solver/state_graph.h"

namespace sgraphs {

// The set of states that are free in a local solve. It spreads along the factors between poses; a plane
// enters with the poses that see it, but does not lead to the other poses that see it, which may be all
// there are. What follows one of its states is in it, and leads nowhere.
class Region {
 public:
  explicit Region(const StateGraph& graph) : graph_(graph), inside_(graph.states.size(), false) {}

  // Adds what is reachable from the seeds in `hops` steps from pose to pose over states that are neither
  // held nor shared, the planes seen from there, and what follows any of these.
  void grow(const std::vector<int>& seeds, int hops);

  const std::vector<int>& members() const { return members_; }
  // Free states next to the region's poses along the factors between poses, and free planes bound to the
  // region's planes; ascending.
  std::vector<int> rim() const;
  // Outside, and free to move.
  bool couldHold(int state) const;

 private:
  bool isPlane(int state) const {
    return graph_.states[static_cast<size_t>(state)].kind == StateKind::kPlane;
  }
  bool isFollower(int state) const { return follows(graph_.states[static_cast<size_t>(state)].kind); }
  // States that share a factor with one of `of`: poses with poses, planes with planes; or across. No
  // followers.
  std::vector<int> neighbours(const std::vector<int>& of, bool across) const;
  std::vector<int> followers(const std::vector<int>& of) const;
  // Sorted, without repetition, and without members, held and shared states.
  std::vector<int> keepFree(std::vector<int> ids) const;
  void add(const std::vector<int>& states);

  const StateGraph& graph_;
  std::vector<bool> inside_;
  std::vector<int> members_;  // ascending
};

}  // namespace sgraphs
