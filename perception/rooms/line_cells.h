#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "perception/rooms/simple_polygon.h"
#include "perception/rooms/wall_candidates.h"

namespace sgraphs {

// A face of an arrangement of lines.
struct LineCell {
  Polygon2d corners;       // convex, counter-clockwise
  std::vector<int> lines;  // of the edge from a corner to the next; -1: the frame around all
  uint64_t front = 0;      // bit i: in front of line i
  double area_m2 = 0;
  double covered_m2 = 0;  // by the parts
};

// Cuts a rectangle by lines (at most 64) and the parts with it. The cell beyond an edge on line i has the
// same `front` but for bit i.
std::vector<LineCell> cellsOf(const Eigen::AlignedBox2d& frame, const std::vector<OutlineLine>& lines,
                              const std::vector<Polygon2d>& parts);

}  // namespace sgraphs
