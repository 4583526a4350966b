#include "tools/eval/plan_view.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tools/eval/eval_plots.h"

namespace sgraphs {
namespace {

constexpr Color kWall{150, 155, 162};
constexpr int kMaxPixels = 2000;
constexpr double kOutlineHeight_m = 1.0;
constexpr double kBodyHeight_m = 0.5;  // a legged robot's

Segments outlines(const Truth& truth, Storey storey) {
  Segments segments;
  if (!truth.mesh) return segments;
  const auto floors = floorHeights(truth);
  for (size_t i = 0; i < floors.size(); ++i)
    if (!storey || i == *storey)
      for (const auto& segment : sliceMesh(*truth.mesh, floors[i] + kOutlineHeight_m))
        segments.push_back(segment);
  return segments;
}

}  // namespace

std::string formatNumber(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

double tickStep(double range, double pieces) {
  const double power = std::pow(10.0, std::floor(std::log10(range / pieces)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power * pieces >= range) return factor * power;
  return 10 * power;
}

std::vector<double> floorHeights(const Truth& truth) {
  if (truth.plan && !truth.plan->floors_z_m.empty()) return truth.plan->floors_z_m;
  std::vector<double> z;
  for (const auto& pose : truth.poses) z.push_back(pose.pose.translation.z());
  std::nth_element(z.begin(), z.begin() + static_cast<ptrdiff_t>(z.size() / 2), z.end());
  return {z[z.size() / 2] - kBodyHeight_m};
}

bool isOn(Storey storey, double z_m, const std::vector<double>& floor_heights_m) {
  if (!storey) return true;
  constexpr double kBelow_m = 0.3;
  size_t of = 0;
  double highest = -INFINITY;
  for (size_t i = 0; i < floor_heights_m.size(); ++i)
    if (floor_heights_m[i] <= z_m + kBelow_m && floor_heights_m[i] > highest) {
      of = i;
      highest = floor_heights_m[i];
    }
  return of == *storey;
}

PlanView::PlanView(const Truth& truth, Storey storey) : walls_(outlines(truth, storey)) {
  Paper extent{Eigen::Vector2d::Constant(INFINITY), Eigen::Vector2d::Constant(-INFINITY)};
  const auto include = [&](const Eigen::Vector2d& p) {
    extent.min = extent.min.cwiseMin(p);
    extent.max = extent.max.cwiseMax(p);
  };
  for (const auto& pose : truth.poses) include(pose.pose.translation.head<2>());
  for (const auto& [a, b] : walls_) include(a), include(b);
  if (truth.plan)
    for (const TrueRoom& room : truth.plan->rooms)
      std::for_each(room.polygon.begin(), room.polygon.end(), include);
  extent_ = {extent.min.array() - 0.5, extent.max.array() + 0.5};
  letter_ = (extent_.max - extent_.min).maxCoeff() * 0.013;
  const double missing = 75 * letter_ - (extent_.max.x() - extent_.min.x());
  if (missing > 0) extent_.min.x() -= missing / 2, extent_.max.x() += missing / 2;
  canvas_ = makePngCanvas(
      {extent_.min - letter_ * Eigen::Vector2d(4, 3), extent_.max + letter_ * Eigen::Vector2d(2, 4)},
      kMaxPixels, 100);
  drawGrid();
}

void PlanView::drawWalls() {
  for (const auto& [a, b] : walls_) canvas_->line(a, b, kWall, 0.15 * letter_);
}

void PlanView::legend(const std::string& text, Color color) {
  const Eigen::Vector2d at(extent_.min.x() + legend_x_, extent_.max.y() + 1.6 * letter_);
  canvas_->line(at + letter_ * Eigen::Vector2d(0, 0.5), at + letter_ * Eigen::Vector2d(2, 0.5), color,
                0.5 * letter_);
  canvas_->text(at + letter_ * Eigen::Vector2d(2.8, 0), text, letter_, kPlotText, TextAnchor::kLeft);
  legend_x_ += (static_cast<double>(text.size()) * 0.92 + 5.5) * letter_;
}

void PlanView::drawGrid() {
  const double step = tickStep((extent_.max - extent_.min).maxCoeff(), 8);
  for (int axis = 0; axis < 2; ++axis)
    for (double i = std::ceil(extent_.min[axis] / step); i * step <= extent_.max[axis]; ++i) {
      const double v = i * step + 0.0;  // no negative zero
      Eigen::Vector2d a = extent_.min, b = extent_.max;
      a[axis] = b[axis] = v;
      canvas_->line(a, b, kPlotGrid, 0.08 * letter_);
      const Eigen::Vector2d shift = axis == 0 ? Eigen::Vector2d(0, -1.7) : Eigen::Vector2d(-0.7, -0.5);
      canvas_->text(a + letter_ * shift, formatNumber("%g", v), 0.9 * letter_, kPlotText,
                    axis == 0 ? TextAnchor::kCenter : TextAnchor::kRight);
    }
}

Segments sliceMesh(const TriangleMesh& mesh, double z_m) {
  Segments segments;
  for (const auto& triangle : mesh.triangles) {
    std::vector<Eigen::Vector2d> crossings;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d &a = mesh.vertices[triangle[k]], &b = mesh.vertices[triangle[(k + 1) % 3]];
      if ((a.z() > z_m) == (b.z() > z_m)) continue;
      crossings.emplace_back((a + (z_m - a.z()) / (b.z() - a.z()) * (b - a)).head<2>());
    }
    if (crossings.size() == 2) segments.emplace_back(crossings[0], crossings[1]);
  }
  return segments;
}

}  // namespace sgraphs
