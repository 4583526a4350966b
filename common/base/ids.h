#pragma once

#include <compare>
#include <cstdint>
#include <string>

namespace sgraphs {

// Identity of a graph node: a type of its own per layer, monotonic, never reused; -1 is "none".
// It prints as the letter of its layer and the number: k12, w7, r3, f0.
template <char Letter>
struct Id {
  int64_t value = -1;

  constexpr bool valid() const { return value >= 0; }
  constexpr auto operator<=>(const Id&) const = default;
  std::string str() const { return valid() ? Letter + std::to_string(value) : std::string("none"); }
};

using KeyframeId = Id<'k'>;
using PlaneId = Id<'w'>;
using RoomId = Id<'r'>;
using FloorId = Id<'f'>;
using VertexId = Id<'p'>;   // of free space
using ClusterId = Id<'c'>;  // of free space
using PassageId = Id<'d'>;  // doorways and other passages between clusters
using LoopId = Id<'l'>;     // loop closures

}  // namespace sgraphs
