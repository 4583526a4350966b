#include "backend/solver/region.h"

#include <algorithm>

namespace sgraphs {

void Region::grow(const std::vector<int>& seeds, int hops) {
  std::vector<int> ring = keepFree(seeds), poses;
  for (int hop = 0; hop <= hops && !ring.empty(); ++hop) {
    add(ring);
    std::erase_if(ring, [&](int state) { return isPlane(state) || isFollower(state); });
    poses.insert(poses.end(), ring.begin(), ring.end());
    ring = keepFree(neighbours(ring, false));
  }
  add(keepFree(neighbours(poses, true)));
  add(keepFree(followers(members_)));
  std::sort(members_.begin(), members_.end());
}

void Region::add(const std::vector<int>& states) {
  for (const int state : states) inside_[static_cast<size_t>(state)] = true;
  members_.insert(members_.end(), states.begin(), states.end());
}

std::vector<int> Region::rim() const {
  return keepFree(neighbours(members_, false));
}

bool Region::couldHold(int id) const {
  const State& state = graph_.states[static_cast<size_t>(id)];
  return !state.held && !state.shared && !inside_[static_cast<size_t>(id)];
}

std::vector<int> Region::neighbours(const std::vector<int>& of, bool across) const {
  std::vector<int> found;
  for (const int state : of)
    for (const int factor : graph_.states[static_cast<size_t>(state)].factors)
      for (const int other : graph_.factors[static_cast<size_t>(factor)].states)
        if (!isFollower(state) && !isFollower(other) && (isPlane(state) != isPlane(other)) == across)
          found.push_back(other);
  return found;
}

std::vector<int> Region::followers(const std::vector<int>& of) const {
  std::vector<int> found;
  for (const int state : of)
    for (const int factor : graph_.states[static_cast<size_t>(state)].factors)
      for (const int other : graph_.factors[static_cast<size_t>(factor)].states)
        if (!isFollower(state) && isFollower(other)) found.push_back(other);
  return found;
}

std::vector<int> Region::keepFree(std::vector<int> ids) const {
  std::erase_if(ids, [&](int id) { return !couldHold(id); });
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

}  // namespace sgraphs
