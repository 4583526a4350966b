#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sgraphs {

struct Color {
  uint8_t r = 0, g = 0, b = 0;
};

// Perceptually even colour scale (dark violet, blue, green, yellow) for s in [0, 1].
Color viridis(double s);

// Square cells, row-major, the first row at the smallest y. Index 0 leaves the paper, i > 0 is palette[i -
// 1].
struct Raster {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  // corner of smallest x and y
  double cell = 1;
  int width = 0;
  int height = 0;
  std::vector<uint8_t> indices;
  std::vector<Color> palette;
};

enum class TextAnchor { kLeft, kCenter, kRight };

// White paper with its own coordinates, y upwards; every length, also of pens and letters, is in paper units.
// A picture is drawn once for both kinds of file.
class Canvas {
 public:
  virtual ~Canvas() = default;
  virtual void raster(const Raster& raster) = 0;
  virtual void polyline(std::span<const Eigen::Vector2d> points, Color color, double pen) = 0;
  virtual void polygon(std::span<const Eigen::Vector2d> points, Color fill) = 0;
  virtual void disc(const Eigen::Vector2d& center, double radius, Color fill) = 0;
  // ASCII; `at` is the anchor on the base line; `size` is the height of a capital letter.
  virtual void text(const Eigen::Vector2d& at, const std::string& text, double size, Color color,
                    TextAnchor anchor) = 0;
  // The file's content.
  virtual std::string encode() const = 0;

  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Color color, double pen) {
    const Eigen::Vector2d ends[] = {a, b};
    polyline(ends, color, pen);
  }
};

struct Paper {
  Eigen::Vector2d min = Eigen::Vector2d::Zero();
  Eigen::Vector2d max = Eigen::Vector2d::Ones();
};

// PNG, anti-aliased; at most `max_pixels` wide and high, at most `max_pixels_per_unit`.
std::unique_ptr<Canvas> makePngCanvas(const Paper& paper, int max_pixels, double max_pixels_per_unit);

// SVG whose user unit is a thousandth of a paper unit: with paper in metres, one unit is a millimetre in the
// building, and the page prints at 1:100.
std::unique_ptr<Canvas> makeSvgCanvas(const Paper& paper);

}  // namespace sgraphs
