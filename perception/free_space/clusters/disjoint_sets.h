#pragma once

#include <cstdint>
#include <vector>

namespace sgraphs {

// Union-find over 0 … n-1.
class DisjointSets {
 public:
  explicit DisjointSets(int32_t n = 0) {
    for (int32_t i = 0; i < n; ++i) add();
  }
  int32_t add() {
    parent_.push_back(static_cast<int32_t>(parent_.size()));
    return parent_.back();
  }
  int32_t find(int32_t i) {
    while (parent_[static_cast<size_t>(i)] != i) {
      auto& up = parent_[static_cast<size_t>(i)];
      up = parent_[static_cast<size_t>(up)];
      i = up;
    }
    return i;
  }
  // The root of `host` stays the root.
  void join(int32_t host, int32_t other) { parent_[static_cast<size_t>(find(other))] = find(host); }
  int32_t size() const { return static_cast<int32_t>(parent_.size()); }

 private:
  std::vector<int32_t> parent_;
};

}  // namespace sgraphs
