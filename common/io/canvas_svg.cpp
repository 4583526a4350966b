#include <cstdio>
#include <string>

#include "common/io/canvas.h"

namespace sgraphs {
namespace {

constexpr double kUserUnits = 1000;  // per paper unit

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f", v);
  return std::string(text) == "-0" ? "0" : text;
}

std::string hex(Color c) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", c.r, c.g, c.b);
  return text;
}

std::string escape(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else
      result += c;
  }
  return result;
}

class SvgCanvas : public Canvas {
 public:
  explicit SvgCanvas(const Paper& paper) : paper_(paper) {}

  // One path per colour, each run of equal cells one rectangle.
  void raster(const Raster& raster) override {
    std::vector<std::string> paths(raster.palette.size());
    for (int row = 0; row < raster.height; ++row)
      for (int col = 0; col < raster.width;) {
        const uint8_t* cells = raster.indices.data() + static_cast<size_t>(row) * raster.width;
        int end = col + 1;
        while (end < raster.width && cells[end] == cells[col]) ++end;
        if (cells[col] != 0) {
          const Eigen::Vector2d top_left = raster.origin + raster.cell * Eigen::Vector2d(col, row + 1);
          const std::string length = number((end - col) * raster.cell * kUserUnits);
          const std::string height = number(raster.cell * kUserUnits);
          paths[cells[col] - 1] +=
              "M" + x(top_left) + " " + y(top_left) + "h" + length + "v" + height + "h-" + length + "z";
        }
        col = end;
      }
    for (size_t i = 0; i < paths.size(); ++i)
      if (!paths[i].empty())
        body_ += "<path fill=\"" + hex(raster.palette[i]) + "\" d=\"" + paths[i] + "\"/>\n";
  }

  void polyline(std::span<const Eigen::Vector2d> points, Color color, double pen) override {
    body_ += "<polyline fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" stroke=\"" +
             hex(color) + "\" stroke-width=\"" + number(pen * kUserUnits) + "\" points=\"" + list(points) +
             "\"/>\n";
  }

  void polygon(std::span<const Eigen::Vector2d> points, Color fill) override {
    body_ += "<polygon fill=\"" + hex(fill) + "\" points=\"" + list(points) + "\"/>\n";
  }

  void disc(const Eigen::Vector2d& center, double radius, Color fill) override {
    body_ += "<circle cx=\"" + x(center) + "\" cy=\"" + y(center) + "\" r=\"" + number(radius * kUserUnits) +
             "\" fill=\"" + hex(fill) + "\"/>\n";
  }

  void text(const Eigen::Vector2d& at, const std::string& text, double size, Color color,
            TextAnchor anchor) override {
    const char* anchors[] = {"start", "middle", "end"};
    // A capital letter of common sans-serif fonts is about 0.72 of the font's size.
    body_ += "<text x=\"" + x(at) + "\" y=\"" + y(at) + "\" font-size=\"" + number(size / 0.72 * kUserUnits) +
             "\" text-anchor=\"" + anchors[static_cast<int>(anchor)] + "\" fill=\"" + hex(color) + "\">" +
             escape(text) + "</text>\n";
  }

  std::string encode() const override {
    const Eigen::Vector2d size = paper_.max - paper_.min;
    const std::string width = number(size.x() * kUserUnits), height = number(size.y() * kUserUnits);
    // 1:100: ten millimetres on the page per paper unit.
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
           number(size.x() * 10) + "mm\" height=\"" + number(size.y() * 10) + "mm\" viewBox=\"0 0 " + width +
           " " + height + "\" font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\">\n<rect width=\"" +
           width + "\" height=\"" + height + "\" fill=\"#ffffff\"/>\n" + body_ + "</svg>\n";
  }

 private:
  std::string x(const Eigen::Vector2d& p) const { return number((p.x() - paper_.min.x()) * kUserUnits); }
  std::string y(const Eigen::Vector2d& p) const { return number((paper_.max.y() - p.y()) * kUserUnits); }

  std::string list(std::span<const Eigen::Vector2d> points) const {
    std::string result;
    for (const auto& p : points) result += (result.empty() ? "" : " ") + x(p) + "," + y(p);
    return result;
  }

  Paper paper_;
  std::string body_;
};

}  // namespace

std::unique_ptr<Canvas> makeSvgCanvas(const Paper& paper) {
  return std::make_unique<SvgCanvas>(paper);
}

}  // namespace sgraphs
