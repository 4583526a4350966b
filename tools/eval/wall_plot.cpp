#include <algorithm>
#include <cmath>

#include "tools/eval/eval_plots.h"
#include "tools/eval/plan_view.h"

namespace sgraphs {
namespace {

constexpr Color kFoundFace{30, 160, 70};
constexpr Color kDoubled{245, 140, 0};
constexpr Color kEstimate{20, 60, 190};
constexpr double kFacePen_m = 0.05;
constexpr double kEstimatePen_m = 0.02;
constexpr double kEstimateShift_m = 0.09;  // towards the side it was seen from, beside its face
constexpr double kMinGap_m = 0.05;

// A face from above, without the columns that are doorway from top to bottom.
void drawFace(Canvas& canvas, const TrueFace& face, Color color) {
  const double step = face.length() / static_cast<double>(face.columns);
  double begin = -1;
  for (size_t column = 0; column <= face.columns; ++column) {
    // Above a door there is wall: a column counts if more than half of it does.
    size_t surface = 0, all = 0;
    for (size_t i = column; column < face.columns && i < face.samples.size(); i += face.columns, ++all)
      surface += face.samples[i].exposed;
    const bool wall = 2 * surface > all;
    if (wall && begin < 0) begin = static_cast<double>(column) * step;
    if (wall || begin < 0) continue;
    const double end = static_cast<double>(column) * step;
    canvas.line(face.point({begin, 0}).head<2>(), face.point({end, 0}).head<2>(), color, kFacePen_m);
    begin = -1;
  }
}

double lowestOf(const TrueFace& face) {
  return face.samples.empty() ? 0 : face.samples.front().at.y();  // rows stand from below
}

void drawEstimate(Canvas& canvas, const EstimatedWall& wall, bool is_false) {
  const Eigen::Vector2d normal = wall.normal.head<2>().normalized(), along(normal.y(), -normal.x());
  double low = INFINITY, high = -INFINITY;
  for (const Eigen::Vector3d& p : wall.polygon) {
    low = std::min(low, along.dot(p.head<2>() - wall.centroid.head<2>()));
    high = std::max(high, along.dot(p.head<2>() - wall.centroid.head<2>()));
  }
  if (high - low < kMinGap_m) return;
  const Eigen::Vector2d at = wall.centroid.head<2>() + (is_false ? 0 : kEstimateShift_m) * normal;
  const Eigen::Vector2d tick = kEstimateShift_m * normal;
  const Eigen::Vector2d a = at + low * along, b = at + high * along;
  const Eigen::Vector2d outline[] = {a + tick, a, b, b + tick};
  canvas.polyline(outline, is_false ? kPlotFalse : kEstimate, is_false ? kFacePen_m : kEstimatePen_m);
}

}  // namespace

std::string wallPlot(const Evaluation& evaluation, const Truth& truth, Storey storey) {
  const WallResult& walls = evaluation.walls;
  if (!walls.missing.empty()) return {};
  PlanView view(truth, storey);
  view.drawWalls();
  const std::vector<double> floors = floorHeights(truth);
  for (size_t f = 0; f < walls.faces.size(); ++f) {
    if (!isOn(storey, lowestOf(walls.faces[f]), floors)) continue;
    if (walls.doubled[f])
      drawFace(view.canvas(), walls.faces[f], kDoubled);
    else if (walls.found[f])
      drawFace(view.canvas(), walls.faces[f], kFoundFace);
    else if (walls.asked(f))
      drawFace(view.canvas(), walls.faces[f], kPlotMissed);
  }
  for (size_t w = 0; w < walls.walls.size(); ++w)
    if (isOn(storey, walls.walls[w].centroid.z(), floors))
      drawEstimate(view.canvas(), walls.walls[w],
                   std::count(walls.false_walls.begin(), walls.false_walls.end(), w) > 0);
  view.legend("found", kFoundFace);
  view.legend("missed", kPlotMissed);
  view.legend("doubled", kDoubled);
  view.legend("estimate", kEstimate);
  view.legend("false", kPlotFalse);
  return view.canvas().encode();
}

}  // namespace sgraphs
