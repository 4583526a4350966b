#include "tools/eval/eval_plots.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/io/canvas.h"

namespace sgraphs {
namespace {

constexpr Color kText{60, 64, 72};
constexpr Color kWall{150, 155, 162};
constexpr Color kGrid{228, 231, 235};
constexpr Color kTruth{30, 34, 40};
constexpr Color kEstimates[] = {
    {20, 110, 220}, {0, 160, 120}, {235, 120, 20}};  // as Evaluation::trajectories
constexpr int kMaxPixels = 2000;
constexpr double kSliceLow_m = 0.25;
constexpr double kSliceHigh_m = 2.0;
constexpr double kOutlineHeight_m = 1.0;
constexpr double kBodyHeight_m = 0.5;  // a legged robot's, where no plan tells the floors
constexpr double kCell_m = 0.05;
constexpr double kErrorScale_m = 0.10;
constexpr int kErrorSteps = 32;

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

// 1, 2 or 5 times a power of ten: about `pieces` of them make up `range`.
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

std::vector<Eigen::Vector2d> seenFromAbove(const std::vector<StampedPose>& poses, const SE3& T_truth_map) {
  std::vector<Eigen::Vector2d> line;
  line.reserve(poses.size());
  for (const auto& pose : poses) line.push_back((T_truth_map * pose.pose.translation).head<2>());
  return line;
}

std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> outlines(const Truth& truth) {
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> segments;
  if (!truth.mesh) return segments;
  for (const double z_m : floorHeights(truth))
    for (const auto& segment : sliceMesh(*truth.mesh, z_m + kOutlineHeight_m)) segments.push_back(segment);
  return segments;
}

// A plan view: paper around the truth's path and the walls, a title line above.
class PlanView {
 public:
  PlanView(const Truth& truth, const std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>>& walls) {
    Paper extent{Eigen::Vector2d::Constant(INFINITY), Eigen::Vector2d::Constant(-INFINITY)};
    const auto include = [&](const Eigen::Vector2d& p) {
      extent.min = extent.min.cwiseMin(p);
      extent.max = extent.max.cwiseMax(p);
    };
    for (const auto& pose : truth.poses) include(pose.pose.translation.head<2>());
    for (const auto& [a, b] : walls) include(a), include(b);
    extent_ = {extent.min.array() - 0.5, extent.max.array() + 0.5};
    letter_ = (extent_.max - extent_.min).maxCoeff() * 0.013;
    const double missing = 75 * letter_ - (extent_.max.x() - extent_.min.x());
    if (missing > 0) extent_.min.x() -= missing / 2, extent_.max.x() += missing / 2;
    canvas_ = makePngCanvas(
        {extent_.min - letter_ * Eigen::Vector2d(4, 3), extent_.max + letter_ * Eigen::Vector2d(2, 4)},
        kMaxPixels, 100);
    drawGrid();
  }

  Canvas& canvas() { return *canvas_; }
  const Paper& extent() const { return extent_; }
  double letter() const { return letter_; }

  void walls(const std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>>& segments) {
    for (const auto& [a, b] : segments) canvas_->line(a, b, kWall, 0.15 * letter_);
  }

  // The next entry of the title line, after a stroke of its colour.
  void legend(const std::string& text, Color color) {
    const Eigen::Vector2d at(extent_.min.x() + legend_x_, extent_.max.y() + 1.6 * letter_);
    canvas_->line(at + letter_ * Eigen::Vector2d(0, 0.5), at + letter_ * Eigen::Vector2d(2, 0.5), color,
                  0.5 * letter_);
    canvas_->text(at + letter_ * Eigen::Vector2d(2.8, 0), text, letter_, kText, TextAnchor::kLeft);
    legend_x_ += (static_cast<double>(text.size()) * 0.92 + 5.5) * letter_;
  }

 private:
  void drawGrid() {
    const double step = tickStep((extent_.max - extent_.min).maxCoeff(), 8);
    for (int axis = 0; axis < 2; ++axis)
      for (double i = std::ceil(extent_.min[axis] / step); i * step <= extent_.max[axis]; ++i) {
        const double v = i * step + 0.0;  // no negative zero
        Eigen::Vector2d a = extent_.min, b = extent_.max;
        a[axis] = b[axis] = v;
        canvas_->line(a, b, kGrid, 0.08 * letter_);
        const Eigen::Vector2d shift = axis == 0 ? Eigen::Vector2d(0, -1.7) : Eigen::Vector2d(-0.7, -0.5);
        canvas_->text(a + letter_ * shift, format("%g", v), 0.9 * letter_, kText,
                      axis == 0 ? TextAnchor::kCenter : TextAnchor::kRight);
      }
  }

  Paper extent_;
  double letter_ = 1;
  double legend_x_ = 0;
  std::unique_ptr<Canvas> canvas_;
};

// Cells hold the mean error of their points.
Raster errorRaster(const MapResult& map, const Truth& truth, const Paper& extent) {
  Raster raster;
  raster.cell = kCell_m;
  raster.origin = extent.min;
  raster.width = static_cast<int>(std::ceil((extent.max.x() - extent.min.x()) / kCell_m));
  raster.height = static_cast<int>(std::ceil((extent.max.y() - extent.min.y()) / kCell_m));
  const size_t cells = static_cast<size_t>(raster.width) * raster.height;
  std::vector<double> sums(cells, 0);
  std::vector<int> counts(cells, 0);
  const auto floors = floorHeights(truth);
  for (size_t i = 0; i < map.points_truth.size(); ++i) {
    const Eigen::Vector3d& p = map.points_truth[i];
    const bool in_slice = std::any_of(floors.begin(), floors.end(), [&](double z) {
      return p.z() > z + kSliceLow_m && p.z() < z + kSliceHigh_m;
    });
    const Eigen::Vector2d cell = ((p.head<2>() - raster.origin) / kCell_m).array().floor();
    if (!in_slice || cell.minCoeff() < 0 || cell.x() >= raster.width || cell.y() >= raster.height) continue;
    const size_t index = static_cast<size_t>(cell.y()) * raster.width + static_cast<size_t>(cell.x());
    sums[index] += map.error.distances_m[i];
    ++counts[index];
  }
  for (int step = 0; step < kErrorSteps; ++step)
    raster.palette.push_back(viridis((step + 0.5) / kErrorSteps));
  raster.indices.assign(cells, 0);
  for (size_t i = 0; i < cells; ++i)
    if (counts[i])
      raster.indices[i] = static_cast<uint8_t>(
          1 + std::min(kErrorSteps - 1, static_cast<int>(sums[i] / counts[i] / kErrorScale_m * kErrorSteps)));
  return raster;
}

// Chart of unit height 1 and width 2 with its own axes.
class Chart {
 public:
  Chart(double max_x, double max_y)
      : max_x_(max_x), max_y_(max_y), canvas_(makePngCanvas({{-0.16, -0.14}, {2.06, 1.12}}, 1600, 1000)) {
    for (double x = 0, step = tickStep(max_x, 10); x <= max_x * 1.0001; x += step) {
      canvas_->line(at(x, 0), at(x, max_y), kGrid, 0.003);
      canvas_->text(at(x, 0) - Eigen::Vector2d(0, 0.05), format("%g", x), 0.022, kText, TextAnchor::kCenter);
    }
    for (double y = 0, step = tickStep(max_y, 5); y <= max_y * 1.0001; y += step) {
      canvas_->line(at(0, y), at(max_x, y), kGrid, 0.003);
      canvas_->text(at(0, y) - Eigen::Vector2d(0.02, 0.011), format("%.4g", y), 0.022, kText,
                    TextAnchor::kRight);
    }
    canvas_->text({1, -0.12}, "time [s]", 0.024, kText, TextAnchor::kCenter);
    canvas_->text({-0.14, 1.05}, "error after alignment [m]", 0.024, kText, TextAnchor::kLeft);
  }

  Eigen::Vector2d at(double x, double y) const { return {2 * x / max_x_, y / max_y_}; }
  Canvas& canvas() { return *canvas_; }

 private:
  double max_x_, max_y_;
  std::unique_ptr<Canvas> canvas_;
};

}  // namespace

std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> sliceMesh(const TriangleMesh& mesh, double z_m) {
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> segments;
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

std::string trajectoryPlot(const Evaluation& evaluation, const Truth& truth) {
  const auto walls = outlines(truth);
  PlanView view(truth, walls);
  view.walls(walls);
  const double pen = 0.28 * view.letter();
  view.canvas().polyline(seenFromAbove(truth.poses, SE3{}), kTruth, 1.6 * pen);
  view.legend("truth", kTruth);
  for (const size_t i : {size_t{2}, size_t{0}}) {  // odometry below, the optimised one on top
    const auto& t = evaluation.trajectories[i];
    if (!t.missing.empty()) continue;
    view.canvas().polyline(seenFromAbove(t.poses, t.absolute.T_truth_map), kEstimates[i], pen);
    view.legend(t.file + format(" (ATE %.3f m)", t.absolute.translation_m.rmse), kEstimates[i]);
  }
  return view.canvas().encode();
}

std::string errorPlot(const Evaluation& evaluation, const Truth& truth) {
  double max_error = 1e-3;
  for (const auto& t : evaluation.trajectories) max_error = std::max(max_error, t.absolute.translation_m.max);
  const Time begin = truth.poses.front().time;
  Chart chart(std::max(1.0, (truth.poses.back().time - begin).seconds()), 1.05 * max_error);
  double legend_x = 0.75;
  for (const size_t i : {size_t{2}, size_t{1}, size_t{0}}) {
    const auto& t = evaluation.trajectories[i];
    if (!t.missing.empty()) continue;
    std::vector<Eigen::Vector2d> line;
    for (const auto& [time, error] : t.absolute.over_time)
      line.push_back(chart.at((time - begin).seconds(), error));
    chart.canvas().polyline(line, kEstimates[i], 0.005);
    chart.canvas().line({legend_x, 1.061}, {legend_x + 0.06, 1.061}, kEstimates[i], 0.01);
    chart.canvas().text({legend_x + 0.08, 1.05}, t.file, 0.024, kText, TextAnchor::kLeft);
    legend_x += 0.45;
  }
  return chart.canvas().encode();
}

std::string mapPlot(const Evaluation& evaluation, const Truth& truth) {
  if (!evaluation.map.missing.empty()) return {};
  const auto walls = outlines(truth);
  PlanView view(truth, walls);
  view.walls(walls);
  view.canvas().raster(errorRaster(evaluation.map, truth, view.extent()));
  for (const double cm : {0.0, 2.5, 5.0, 7.5})
    view.legend(format("%g cm", cm), viridis(cm / 100 / kErrorScale_m));
  view.legend("10 cm or more", viridis(1));
  return view.canvas().encode();
}

}  // namespace sgraphs
