#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "common/io/canvas.h"

namespace sgraphs {
namespace {

// Drawn at twice the size and averaged down: smoother than OpenCV's own anti-aliasing alone, and letters of
// its stroke font look even.
constexpr int kOversampling = 2;
constexpr int kSubpixelBits = 4;  // OpenCV's fixed-point coordinates

cv::Scalar bgr(Color c) {
  return {static_cast<double>(c.b), static_cast<double>(c.g), static_cast<double>(c.r)};
}

class PngCanvas : public Canvas {
 public:
  PngCanvas(const Paper& paper, int max_pixels, double max_pixels_per_unit) : paper_(paper) {
    const Eigen::Vector2d size = paper.max - paper.min;
    if (!(size.minCoeff() > 0) || !size.allFinite()) throw std::logic_error("makePngCanvas: empty paper");
    const double scale = std::min(max_pixels_per_unit, max_pixels / size.maxCoeff());
    const auto pixels = [&](double length) {
      return std::max(1, static_cast<int>(std::lround(length * scale)));
    };
    final_size_ = {pixels(size.x()), pixels(size.y())};
    scale_ = scale * kOversampling;
    image_ = cv::Mat(final_size_ * kOversampling, CV_8UC3, cv::Scalar::all(255));
  }

  void raster(const Raster& raster) override {
    for (int row = 0; row < raster.height; ++row)
      for (int col = 0; col < raster.width; ++col) {
        const uint8_t index = raster.indices[static_cast<size_t>(row) * raster.width + col];
        if (index == 0) continue;
        const Eigen::Vector2d low = raster.origin + raster.cell * Eigen::Vector2d(col, row);
        const cv::Point a = pixel(low);
        const cv::Point b = pixel(low + Eigen::Vector2d::Constant(raster.cell));
        const cv::Rect box(a.x, b.y, std::max(1, b.x - a.x), std::max(1, a.y - b.y));
        cv::rectangle(image_, box, bgr(raster.palette[index - 1]), cv::FILLED);
      }
  }

  void polyline(std::span<const Eigen::Vector2d> points, Color color, double pen) override {
    std::vector<cv::Point> fixed = fixedPoints(points);
    if (fixed.size() == 1) fixed.push_back(fixed.front());
    const int thickness = std::max(1, static_cast<int>(std::lround(pen * scale_)));
    cv::polylines(image_, fixed, false, bgr(color), thickness, cv::LINE_AA, kSubpixelBits);
  }

  void polygon(std::span<const Eigen::Vector2d> points, Color fill) override {
    cv::fillPoly(image_, std::vector<std::vector<cv::Point>>{fixedPoints(points)}, bgr(fill), cv::LINE_AA,
                 kSubpixelBits);
  }

  void disc(const Eigen::Vector2d& center, double radius, Color fill) override {
    const cv::Point at = fixedPoints(std::span(&center, 1)).front();
    const int fixed_radius = static_cast<int>(std::lround(radius * scale_ * (1 << kSubpixelBits)));
    cv::circle(image_, at, fixed_radius, bgr(fill), cv::FILLED, cv::LINE_AA, kSubpixelBits);
  }

  void text(const Eigen::Vector2d& at, const std::string& text, double size, Color color,
            TextAnchor anchor) override {
    const int height = std::max(1, static_cast<int>(std::lround(size * scale_)));
    const int thickness = std::max(1, static_cast<int>(std::lround(height * 0.11)));
    const double font_scale = cv::getFontScaleFromHeight(cv::FONT_HERSHEY_SIMPLEX, height, thickness);
    int baseline = 0;
    const int width = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, font_scale, thickness, &baseline).width;
    cv::Point where = pixel(at);
    if (anchor == TextAnchor::kCenter) where.x -= width / 2;
    if (anchor == TextAnchor::kRight) where.x -= width;
    cv::putText(image_, text, where, cv::FONT_HERSHEY_SIMPLEX, font_scale, bgr(color), thickness,
                cv::LINE_AA);
  }

  std::string encode() const override {
    cv::Mat small;
    cv::resize(image_, small, final_size_, 0, 0, cv::INTER_AREA);
    std::vector<uchar> bytes;
    if (!cv::imencode(".png", small, bytes)) throw std::runtime_error("OpenCV cannot encode PNG");
    return {bytes.begin(), bytes.end()};
  }

 private:
  Eigen::Vector2d toImage(const Eigen::Vector2d& p) const {
    return {(p.x() - paper_.min.x()) * scale_, (paper_.max.y() - p.y()) * scale_};
  }

  cv::Point pixel(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d image = toImage(p);
    return {static_cast<int>(std::lround(image.x())), static_cast<int>(std::lround(image.y()))};
  }

  std::vector<cv::Point> fixedPoints(std::span<const Eigen::Vector2d> points) const {
    std::vector<cv::Point> fixed;
    for (const auto& p : points) {
      // OpenCV addresses pixel centres, hence the half.
      const Eigen::Vector2d q = (toImage(p) - Eigen::Vector2d::Constant(0.5)) * (1 << kSubpixelBits);
      fixed.emplace_back(static_cast<int>(std::lround(q.x())), static_cast<int>(std::lround(q.y())));
    }
    return fixed;
  }

  Paper paper_;
  double scale_ = 1;
  cv::Size final_size_;
  cv::Mat image_;
};

}  // namespace

std::unique_ptr<Canvas> makePngCanvas(const Paper& paper, int max_pixels, double max_pixels_per_unit) {
  return std::make_unique<PngCanvas>(paper, max_pixels, max_pixels_per_unit);
}

}  // namespace sgraphs
