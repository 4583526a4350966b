#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/io/canvas.h"
#include "tools/eval/truth.h"

namespace sgraphs {

using Segments = std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>>;

inline constexpr Color kPlotText{60, 64, 72};
inline constexpr Color kPlotGrid{228, 231, 235};
inline constexpr Color kPlotMissed{215, 35, 45};
inline constexpr Color kPlotFalse{190, 0, 190};

std::string formatNumber(const char* pattern, double value);

// 1, 2 or 5 times a power of ten: about `pieces` of them make up `range`.
double tickStep(double range, double pieces);

// Heights of the storeys' floors; where no plan tells them, what a legged robot's path says.
std::vector<double> floorHeights(const Truth& truth);

// A storey of the building, an index of floorHeights(), or all of them on top of each other.
using Storey = std::optional<size_t>;

// What stands or lies at a height belongs to the highest floor that is not above it (by more than 0.3 m).
bool isOn(Storey storey, double z_m, const std::vector<double>& floor_heights_m);

// A picture of the building from above: paper around the truth's path and the walls, a grid in metres, a line
// of legend above.
class PlanView {
 public:
  PlanView(const Truth& truth, Storey storey);

  Canvas& canvas() { return *canvas_; }
  const Paper& extent() const { return extent_; }
  double letter() const { return letter_; }  // height of a capital [m]

  // The building's surfaces at 1 m over each floor, in grey.
  void drawWalls();
  // The next entry of the legend, after a stroke of its colour.
  void legend(const std::string& text, Color color);

 private:
  void drawGrid();

  Segments walls_;
  Paper extent_;
  double letter_ = 1;
  double legend_x_ = 0;
  std::unique_ptr<Canvas> canvas_;
};

}  // namespace sgraphs
