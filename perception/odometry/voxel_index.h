#pragma once

#include <cstdint>
#include <vector>

namespace sgraphs {

// Map from 64-bit keys to indices, with open addressing: several times faster than std::unordered_map, and
// never iterated, so its inner order reaches no output.
class VoxelIndex {
 public:
  VoxelIndex() { clear(); }

  void clear() {
    slots_.assign(kInitialSlots, Slot{});
    size_ = 0;
  }

  // Index stored for the key; -1 if there is none.
  int32_t find(uint64_t key) const {
    for (size_t i = hash(key);; ++i) {
      const Slot& slot = slots_[i & (slots_.size() - 1)];
      if (slot.index < 0 || slot.key == key) return slot.index;
    }
  }

  // Stores index under a key that is not there yet.
  void insert(uint64_t key, int32_t index) {
    if (2 * (size_ + 1) > slots_.size()) grow();
    place(key, index);
    ++size_;
  }

  void visitState(auto& archive) { archive(slots_, size_); }

  // One key from three cell coordinates (20 bits each: 524,288 cells either way) and a class below 16.
  static uint64_t pack(int64_t x, int64_t y, int64_t z, uint64_t cls) {
    constexpr int64_t kOffset = 1 << 19;
    constexpr uint64_t kMask = (1u << 20) - 1;
    return (cls << 60) | ((static_cast<uint64_t>(x + kOffset) & kMask) << 40) |
           ((static_cast<uint64_t>(y + kOffset) & kMask) << 20) |
           (static_cast<uint64_t>(z + kOffset) & kMask);
  }

 private:
  struct Slot {
    uint64_t key = 0;
    int32_t index = -1;
  };
  static constexpr size_t kInitialSlots = 1024;

  static size_t hash(uint64_t key) {
    key ^= key >> 31;
    key *= 0x9E3779B97F4A7C15ull;
    return static_cast<size_t>(key ^ (key >> 29));
  }
  void place(uint64_t key, int32_t index) {
    size_t i = hash(key);
    while (slots_[i & (slots_.size() - 1)].index >= 0) ++i;
    slots_[i & (slots_.size() - 1)] = {key, index};
  }
  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old)
      if (slot.index >= 0) place(slot.key, slot.index);
  }

  std::vector<Slot> slots_;
  size_t size_ = 0;
};

}  // namespace sgraphs
