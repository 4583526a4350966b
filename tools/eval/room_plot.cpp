#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/geometry/convex_polygon.h"
#include "tools/eval/eval_plots.h"
#include "tools/eval/plan_view.h"

namespace sgraphs {
namespace {

constexpr Color kFoundRoomFill{205, 236, 212};
constexpr Color kFoundRoom{30, 140, 65};
constexpr Color kOther{150, 155, 162};  // true, but not asked for
constexpr double kHatchStep_m = 0.5;
constexpr double kTick_m = 0.35;

void outline(Canvas& canvas, Corners polygon, Color color, double pen) {
  polygon.push_back(polygon.front());
  canvas.polyline(polygon, color, pen);
}

// Lines that rise at 45 degrees, inside the polygon.
void hatch(Canvas& canvas, Corners polygon, Color color, double pen) {
  const Eigen::Rotation2Dd level(-M_PI / 4), back(M_PI / 4);
  double low = INFINITY, high = -INFINITY;
  for (Eigen::Vector2d& p : polygon) {
    p = level * p;
    low = std::min(low, p.y());
    high = std::max(high, p.y());
  }
  for (double y = low + 0.5 * kHatchStep_m; y < high; y += kHatchStep_m)
    for (const auto& [begin, end] : insideAt({polygon}, y))
      canvas.line(back * Eigen::Vector2d(begin, y), back * Eigen::Vector2d(end, y), color, pen);
}

// Letters with white paper around them.
void label(PlanView& view, const Eigen::Vector2d& at, const std::string& text, Color color) {
  const double letter = view.letter();
  const Eigen::Vector2d half(letter * (0.46 * static_cast<double>(text.size()) + 0.4), 0.9 * letter);
  const Eigen::Vector2d corners[] = {at - half, at + Eigen::Vector2d(half.x(), -half.y()), at + half,
                                     at + Eigen::Vector2d(-half.x(), half.y())};
  view.canvas().polygon(corners, {255, 255, 255});
  view.canvas().text(at - Eigen::Vector2d(0, 0.5 * letter), text, letter, color, TextAnchor::kCenter);
}

Color colorOf(const RoomResult::Truth& room) {
  if (room.estimate) return kFoundRoom;
  return room.asked ? kPlotMissed : kOther;
}

std::string textOf(const RoomResult::Truth& room) {
  if (room.estimate) return room.id + formatNumber(" %.2f", room.iou);
  return room.asked ? room.id + " missed" : room.id;
}

// A true doorway's threshold with a stroke across each end.
void drawThreshold(PlanView& view, const Plan& plan, const TrueDoorway& doorway, Color color) {
  const Eigen::Vector2d center = doorway.position.head<2>();
  const double pen = 0.25 * view.letter();
  const auto threshold = thresholdOf(plan, doorway);
  if (!threshold) return view.canvas().disc(center, 0.5 * doorway.width_m, color);
  const auto& [begin, end] = *threshold;
  const Eigen::Vector2d along = (end - begin).normalized(), across(-along.y(), along.x());
  view.canvas().line(begin, end, color, pen);
  for (const Eigen::Vector2d& p : {begin, end})
    view.canvas().line(p - 0.5 * kTick_m * across, p + 0.5 * kTick_m * across, color, pen);
}

void drawDoorways(PlanView& view, const Evaluation& evaluation, const Plan& plan, size_t storey) {
  const DoorwayResult& doorways = evaluation.doorways;
  for (size_t i = 0; i < plan.doorways.size(); ++i) {
    if (plan.doorways[i].floor != storey) continue;
    const auto& truth = doorways.truth[i];
    const bool asked = truth.walked_through || truth.of_asked_room;
    const bool judged = doorways.missing.empty();
    const Color color = truth.estimate ? kFoundRoom : asked && judged ? kPlotMissed : kOther;
    drawThreshold(view, plan, plan.doorways[i], color);
  }
  for (const auto& estimate : doorways.estimates)
    if (estimate.storey == storey)
      view.canvas().disc(estimate.position.head<2>(), 0.4 * view.letter(),
                         estimate.is_true ? kFoundRoom : kPlotFalse);
}

void drawRooms(PlanView& view, const RoomResult& rooms, const Plan& plan, size_t storey) {
  const double pen = 0.2 * view.letter();
  const auto each = [&](const auto& draw) {
    for (size_t i = 0; i < plan.rooms.size(); ++i)
      if (plan.rooms[i].floor == storey) draw(plan.rooms[i].polygon, rooms.truth[i]);
  };
  each([&](const Corners&, const RoomResult::Truth& room) {
    if (room.estimate) view.canvas().polygon(rooms.estimates[*room.estimate].polygon, kFoundRoomFill);
  });
  view.drawWalls();
  each([&](const Corners& polygon, const RoomResult::Truth& room) {
    outline(view.canvas(), polygon, colorOf(room), pen);
  });
  for (const auto& estimate : rooms.estimates) {
    if (estimate.storey != storey || estimate.why_false.empty() || estimate.polygon.size() < 3) continue;
    hatch(view.canvas(), estimate.polygon, kPlotFalse, 0.6 * pen);
    outline(view.canvas(), estimate.polygon, kPlotFalse, pen);
  }
}

void writeNames(PlanView& view, const RoomResult& rooms, const Plan& plan, size_t storey) {
  for (size_t i = 0; i < plan.rooms.size(); ++i)
    if (plan.rooms[i].floor == storey)
      label(view, polygonCentroid(plan.rooms[i].polygon), textOf(rooms.truth[i]), colorOf(rooms.truth[i]));
  // Below the middle, where a true room's name may stand already.
  for (const auto& estimate : rooms.estimates)
    if (estimate.storey == storey && !estimate.why_false.empty() && estimate.polygon.size() >= 3)
      label(view, polygonCentroid(estimate.polygon) - Eigen::Vector2d(0, 2.2 * view.letter()),
            estimate.id + " false", kPlotFalse);
}

}  // namespace

std::string roomPlot(const Evaluation& evaluation, const Truth& truth, size_t storey) {
  const RoomResult& rooms = evaluation.rooms;
  if (!rooms.missing.empty() || !truth.plan) return {};
  PlanView view(truth, storey);
  drawRooms(view, rooms, *truth.plan, storey);
  drawDoorways(view, evaluation, *truth.plan, storey);
  writeNames(view, rooms, *truth.plan, storey);
  view.legend("found, with IoU", kFoundRoom);
  view.legend("missed", kPlotMissed);
  view.legend("false", kPlotFalse);
  view.legend("not asked for", kOther);
  return view.canvas().encode();
}

}  // namespace sgraphs
