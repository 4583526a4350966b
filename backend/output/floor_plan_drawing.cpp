#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <set>

#include "backend/output/floor_plan.h"

namespace sgraphs {
namespace {

constexpr Color kText{60, 64, 72};
constexpr Color kFaint{238, 240, 243};
constexpr Color kFine{222, 226, 231};
constexpr Color kStart{22, 150, 75};
constexpr Color kEnd{208, 38, 48};
constexpr Color kWhite{255, 255, 255};
constexpr Color kWall{24, 28, 34};
// Soft tints in turn, so that neighbours differ; corridors are grey.
constexpr Color kRoomTints[] = {{225, 238, 250}, {250, 236, 220}, {228, 245, 226},
                                {246, 228, 238}, {250, 247, 215}, {232, 230, 248}};
constexpr Color kCorridorTint{236, 236, 236};
constexpr Color kDoor{200, 110, 30};
// Thin enough that the two faces of a 5 cm wall, or a wall mapped twice, are two lines.
constexpr double kWallPen_m = 0.035;
constexpr double kWallTick_m = 0.07;
constexpr int kColorSteps = 100;
constexpr int kMaxPixels = 2400;
constexpr double kMaxPixelsPerMetre = 100;

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

// 1, 2 or 5 times a power of ten, near `length`.
double roundLength(double length) {
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= length) return factor * power;
  return power;
}

class Drawing {
 public:
  explicit Drawing(const FloorPlan& plan)
      : plan_(plan), extent_(plan.extent), letter_((extent_.max - extent_.min).maxCoeff() * 0.0135) {
    // A narrow storey still needs room for its captions.
    const double missing = 42 * letter_ - (extent_.max.x() - extent_.min.x());
    if (missing > 0) extent_.min.x() -= missing / 2, extent_.max.x() += missing / 2;
  }

  Paper paper() const {
    return {extent_.min - letter_ * Eigen::Vector2d(5, 7), extent_.max + letter_ * Eigen::Vector2d(2, 4)};
  }

  void draw(Canvas& canvas) const {
    drawGrid(canvas);
    drawRooms(canvas);
    if (!plan_.ink.indices.empty()) canvas.raster(plan_.ink);
    drawPath(canvas);
    drawWalls(canvas);
    drawDoors(canvas);
    drawNames(canvas);
    drawTitle(canvas);
    drawScaleBar(canvas);
    drawLegend(canvas);
  }

 private:
  void drawGrid(Canvas& canvas) const {
    const double label_step = std::max(1.0, roundLength((extent_.max - extent_.min).maxCoeff() / 5));
    const double fine_step = std::max(1.0, label_step / 5);
    for (int axis = 0; axis < 2; ++axis)
      for (const double step : {fine_step, label_step}) {
        const int first = static_cast<int>(std::ceil(extent_.min[axis] / step));
        const int last = static_cast<int>(std::floor(extent_.max[axis] / step));
        for (int i = first; i <= last; ++i) {
          Eigen::Vector2d a = extent_.min, b = extent_.max;
          a[axis] = b[axis] = i * step;
          canvas.line(a, b, step == label_step ? kFine : kFaint, letter_ * 0.1);
          if (step == label_step) drawGridLabel(canvas, axis, i * step);
        }
      }
  }

  void drawGridLabel(Canvas& canvas, int axis, double value) const {
    const std::string label = format("%.0f", value);
    if (axis == 0)
      canvas.text({value, extent_.min.y() - 1.8 * letter_}, label, letter_, kText, TextAnchor::kCenter);
    else
      canvas.text({extent_.min.x() - 0.8 * letter_, value - 0.5 * letter_}, label, letter_, kText,
                  TextAnchor::kRight);
  }

  Color colorAt(double time_s) const {
    const double s = plan_.duration_s > 0 ? time_s / plan_.duration_s : 0;
    // The scale's yellow end vanishes on white paper.
    return viridis(0.92 * std::round(s * kColorSteps) / kColorSteps);
  }

  // A white rim keeps the path apart from what it crosses.
  void drawPath(Canvas& canvas) const {
    const double pen = letter_ * (plan_.walls.empty() ? 0.32 : 0.2);
    for (const bool rim : {true, false}) {
      std::vector<Eigen::Vector2d> run;
      const auto flush = [&](double time_s) {
        if (run.size() > 1) canvas.polyline(run, rim ? kWhite : colorAt(time_s), rim ? 2 * pen : pen);
        run.clear();
      };
      const double step_s = plan_.duration_s / kColorSteps;
      double begin_s = 0;
      for (const auto& point : plan_.path) {
        if (!point.joined) flush(begin_s);
        if (run.empty()) begin_s = point.time_s;
        run.push_back(point.position_map);
        if (!rim && point.time_s - begin_s >= step_s) {
          flush(begin_s);
          begin_s = point.time_s;
          run.push_back(point.position_map);
        }
      }
      flush(begin_s);
    }
    if (plan_.path.empty()) return;
    drawMark(canvas, plan_.path.back().position_map, kEnd);
    drawMark(canvas, plan_.path.front().position_map, kStart);
  }

  // Each face ends in ticks towards the side it was seen from, so pieces in one line stay apart.
  void drawWalls(Canvas& canvas) const {
    for (const FloorPlan::WallLine& wall : plan_.walls) {
      const Eigen::Vector2d along = (wall.b - wall.a).normalized();
      const Eigen::Vector2d tick = kWallTick_m * Eigen::Vector2d(-along.y(), along.x());
      const Eigen::Vector2d outline[] = {wall.a + tick, wall.a, wall.b, wall.b + tick};
      canvas.polyline(outline, kWall, kWallPen_m);
    }
  }

  void drawRooms(Canvas& canvas) const {
    for (const FloorPlan::Room& room : plan_.rooms)
      canvas.polygon(room.polygon,
                     room.corridor ? kCorridorTint : kRoomTints[room.id.value % std::size(kRoomTints)]);
  }

  void drawDoors(Canvas& canvas) const {
    for (const FloorPlan::Door& door : plan_.doors) {
      const Eigen::Vector2d along = (door.right - door.left).normalized();
      const Eigen::Vector2d tick = 0.12 * Eigen::Vector2d(-along.y(), along.x());
      canvas.line(door.left, door.right, kDoor, kWallPen_m);
      canvas.line(door.left - tick, door.left + tick, kDoor, kWallPen_m);
      canvas.line(door.right - tick, door.right + tick, kDoor, kWallPen_m);
      canvas.text(0.5 * (door.left + door.right) + tick + Eigen::Vector2d(0, 0.05),
                  format("%.2f", door.width_m), 0.7 * letter_, kDoor, TextAnchor::kCenter);
    }
  }

  // Name and area, small enough for the room.
  void drawNames(Canvas& canvas) const {
    for (const FloorPlan::Room& room : plan_.rooms) {
      const double size = std::clamp(0.25 * room.room_for_label_m, 0.4 * letter_, 1.2 * letter_);
      const Eigen::Vector2d up(0, 0.35 * size);
      canvas.text(room.label_at + up, (room.corridor ? "Corridor " : "Room ") + room.id.str(), size, kText,
                  TextAnchor::kCenter);
      canvas.text(room.label_at - 1.4 * size * Eigen::Vector2d(0, 1) + up, format("%.1f m2", room.area_m2),
                  0.8 * size, kText, TextAnchor::kCenter);
    }
  }

  void drawMark(Canvas& canvas, const Eigen::Vector2d& at, Color color) const {
    canvas.disc(at, 0.85 * letter_, kWhite);
    canvas.disc(at, 0.6 * letter_, color);
  }

  double pathLength() const {
    double length = 0;
    for (size_t i = 1; i < plan_.path.size(); ++i)
      if (plan_.path[i].joined)
        length += (plan_.path[i].position_map - plan_.path[i - 1].position_map).norm();
    return length;
  }

  double countWalls() const {
    std::set<PlaneId> walls;
    for (const FloorPlan::WallLine& wall : plan_.walls) walls.insert(wall.wall);
    return static_cast<double>(walls.size());
  }

  void drawTitle(Canvas& canvas) const {
    canvas.text({extent_.min.x(), extent_.max.y() + 1.4 * letter_},
                "Floor " + plan_.floor.str() + (plan_.height_known ? "" : ", height not known"),
                1.5 * letter_, kText, TextAnchor::kLeft);
    canvas.text({extent_.max.x(), extent_.max.y() + 1.4 * letter_},
                (plan_.rooms.empty() ? std::string()
                                     : format("%.0f rooms,  ", static_cast<double>(plan_.rooms.size()))) +
                    (plan_.walls.empty() ? std::string() : format("%.0f wall faces,  ", countWalls())) +
                    format("path %.1f m", pathLength()) + format(",  %.0f s", plan_.duration_s),
                letter_, kText, TextAnchor::kRight);
  }

  void drawScaleBar(Canvas& canvas) const {
    const double length = roundLength((extent_.max.x() - extent_.min.x()) / 4);
    const Eigen::Vector2d a(extent_.min.x(), extent_.min.y() - 4.6 * letter_);
    const Eigen::Vector2d b = a + Eigen::Vector2d(length, 0), tick(0, 0.35 * letter_);
    canvas.line(a, b, kText, 0.2 * letter_);
    canvas.line(a - tick, a + tick, kText, 0.2 * letter_);
    canvas.line(b - tick, b + tick, kText, 0.2 * letter_);
    canvas.text(b + letter_ * Eigen::Vector2d(0.8, -0.5), format("%g m", length), letter_, kText,
                TextAnchor::kLeft);
  }

  // Start, the scale of time, end; from right to left.
  void drawLegend(Canvas& canvas) const {
    const double y = extent_.min.y() - 4.6 * letter_;
    double x = extent_.max.x();
    const Eigen::Vector2d down(0, -0.5 * letter_);
    const std::string end = format("end %.0f s", plan_.duration_s);
    canvas.text(Eigen::Vector2d(x, y) + down, end, letter_, kText, TextAnchor::kRight);
    x -= (static_cast<double>(end.size()) * 0.95 + 1.0) * letter_;
    canvas.disc({x, y}, 0.6 * letter_, kEnd);
    x -= 1.5 * letter_;
    constexpr int kPieces = 40;
    const double bar = 9 * letter_;
    for (int i = 0; i < kPieces; ++i) {
      const double s = static_cast<double>(i) / (kPieces - 1);
      const Eigen::Vector2d from(x - bar + bar * i / kPieces, y);
      canvas.line(from, from + Eigen::Vector2d(bar / kPieces, 0), colorAt(s * plan_.duration_s),
                  0.5 * letter_);
    }
    x -= bar + 1.5 * letter_;
    canvas.disc({x, y}, 0.6 * letter_, kStart);
    canvas.text(Eigen::Vector2d(x - letter_, y) + down, "start", letter_, kText, TextAnchor::kRight);
  }

  const FloorPlan& plan_;
  Paper extent_;
  double letter_;  // height of a capital [m]
};

}  // namespace

std::string floorPlanPng(const FloorPlan& plan) {
  const Drawing drawing(plan);
  const auto canvas = makePngCanvas(drawing.paper(), kMaxPixels, kMaxPixelsPerMetre);
  drawing.draw(*canvas);
  return canvas->encode();
}

std::string floorPlanSvg(const FloorPlan& plan) {
  const Drawing drawing(plan);
  const auto canvas = makeSvgCanvas(drawing.paper());
  drawing.draw(*canvas);
  return canvas->encode();
}

}  // namespace sgraphs
