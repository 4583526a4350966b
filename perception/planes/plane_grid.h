#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace sgraphs {

// A binary image of points in a plane. The border of `margin` cells around the points is empty, and the outer
// cells end exactly where the points end, so that the outline of a rectangle is that rectangle.
class PlaneGrid {
 public:
  PlaneGrid(const std::vector<Eigen::Vector2d>& points, double cell_m, int margin);

  int cols() const { return cols_; }
  int rows() const { return rows_; }
  // Cell of a place, the nearest one within the points' bounds if it lies beyond them.
  size_t cellOf(const Eigen::Vector2d& p) const;
  bool isFilled(const Eigen::Vector2d& p) const;
  // Corner of a cell by column and row of its lower left.
  Eigen::Vector2d corner(int col, int row) const;
  bool at(int col, int row) const;
  int count() const;

  // Squares of radius `cells` around each filled cell are filled; eroding does the same for empty ones.
  void dilate(int cells);
  void erode(int cells);

  // Number (from 0, in order of the first cell) of the region of edge-connected filled cells that each cell
  // belongs to; -1: empty.
  std::vector<int32_t> regions(int* num_regions) const;

 private:
  void spread(int cells, uint8_t value);

  int cols_ = 0, rows_ = 0;
  int margin_ = 0;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();  // lower left corner of the cell (margin, margin)
  Eigen::Vector2d cell_ = Eigen::Vector2d::Ones();    // [m]
  std::vector<uint8_t> cells_;
};

}  // namespace sgraphs
