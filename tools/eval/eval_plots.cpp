#include "tools/eval/eval_plots.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tools/eval/plan_view.h"

namespace sgraphs {
namespace {

constexpr Color kTruth{30, 34, 40};
constexpr Color kEstimates[] = {
    {20, 110, 220}, {0, 160, 120}, {235, 120, 20}};  // as Evaluation::trajectories
constexpr double kSliceLow_m = 0.25;
constexpr double kSliceHigh_m = 2.0;
constexpr double kCell_m = 0.05;
constexpr double kErrorScale_m = 0.10;
constexpr int kErrorSteps = 32;

// The path as far as it is on the storey, in pieces.
void drawPath(PlanView& view, const std::vector<StampedPose>& poses, const SE3& T_truth_map, Storey storey,
              const std::vector<double>& floors, Color color, double pen) {
  std::vector<Eigen::Vector2d> piece;
  const auto draw = [&] {
    if (piece.size() > 1) view.canvas().polyline(piece, color, pen);
    piece.clear();
  };
  for (const auto& pose : poses) {
    const Eigen::Vector3d p = T_truth_map * pose.pose.translation;
    if (isOn(storey, p.z(), floors))
      piece.push_back(p.head<2>());
    else
      draw();
  }
  draw();
}

// Cells hold the mean error of their points.
Raster errorRaster(const MapResult& map, const Truth& truth, Storey storey, const Paper& extent) {
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
    bool in_slice = false;
    for (size_t f = 0; f < floors.size(); ++f)
      in_slice = in_slice || ((!storey || f == *storey) && p.z() > floors[f] + kSliceLow_m &&
                              p.z() < floors[f] + kSliceHigh_m);
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
      canvas_->line(at(x, 0), at(x, max_y), kPlotGrid, 0.003);
      canvas_->text(at(x, 0) - Eigen::Vector2d(0, 0.05), formatNumber("%g", x), 0.022, kPlotText,
                    TextAnchor::kCenter);
    }
    for (double y = 0, step = tickStep(max_y, 5); y <= max_y * 1.0001; y += step) {
      canvas_->line(at(0, y), at(max_x, y), kPlotGrid, 0.003);
      canvas_->text(at(0, y) - Eigen::Vector2d(0.02, 0.011), formatNumber("%.4g", y), 0.022, kPlotText,
                    TextAnchor::kRight);
    }
    canvas_->text({1, -0.12}, "time [s]", 0.024, kPlotText, TextAnchor::kCenter);
    canvas_->text({-0.14, 1.05}, "error after alignment [m]", 0.024, kPlotText, TextAnchor::kLeft);
  }

  Eigen::Vector2d at(double x, double y) const { return {2 * x / max_x_, y / max_y_}; }
  Canvas& canvas() { return *canvas_; }

 private:
  double max_x_, max_y_;
  std::unique_ptr<Canvas> canvas_;
};

}  // namespace

std::string trajectoryPlot(const Evaluation& evaluation, const Truth& truth, Storey storey) {
  PlanView view(truth, storey);
  view.drawWalls();
  const std::vector<double> floors = floorHeights(truth);
  const double pen = 0.28 * view.letter();
  drawPath(view, truth.poses, SE3{}, storey, floors, kTruth, 1.6 * pen);
  view.legend("truth", kTruth);
  for (const size_t i : {size_t{2}, size_t{0}}) {  // odometry below, the optimised one on top
    const auto& t = evaluation.trajectories[i];
    if (!t.missing.empty()) continue;
    drawPath(view, t.poses, t.absolute.T_truth_map, storey, floors, kEstimates[i], pen);
    view.legend(t.file + formatNumber(" (ATE %.3f m)", t.absolute.translation_m.rmse), kEstimates[i]);
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
    chart.canvas().text({legend_x + 0.08, 1.05}, t.file, 0.024, kPlotText, TextAnchor::kLeft);
    legend_x += 0.45;
  }
  return chart.canvas().encode();
}

std::string mapPlot(const Evaluation& evaluation, const Truth& truth, Storey storey) {
  if (!evaluation.map.missing.empty()) return {};
  PlanView view(truth, storey);
  view.drawWalls();
  view.canvas().raster(errorRaster(evaluation.map, truth, storey, view.extent()));
  for (const double cm : {0.0, 2.5, 5.0, 7.5})
    view.legend(formatNumber("%g cm", cm), viridis(cm / 100 / kErrorScale_m));
  view.legend("10 cm or more", viridis(1));
  return view.canvas().encode();
}

std::vector<std::pair<std::string, std::string>> evaluationPlots(const Evaluation& evaluation,
                                                                 const Truth& truth) {
  std::vector<std::pair<std::string, std::string>> plots;
  const auto add = [&](const std::string& name, std::string png) {
    if (!png.empty()) plots.emplace_back(name, std::move(png));
  };
  add("eval_error.png", errorPlot(evaluation, truth));
  const size_t storeys = floorHeights(truth).size();
  for (size_t i = 0; i < storeys; ++i) {
    const Storey storey = storeys == 1 ? Storey() : Storey(i);
    const std::string end = storeys == 1 ? ".png" : "_" + std::to_string(i) + ".png";
    add("eval_trajectory" + end, trajectoryPlot(evaluation, truth, storey));
    add("eval_map" + end, mapPlot(evaluation, truth, storey));
    add("eval_walls" + end, wallPlot(evaluation, truth, storey));
    if (truth.plan && !truth.plan->floors_z_m.empty())
      add("eval_rooms" + end, roomPlot(evaluation, truth, i));
  }
  return plots;
}

}  // namespace sgraphs
