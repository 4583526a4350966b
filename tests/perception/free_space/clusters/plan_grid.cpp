#include "tests/perception/free_space/clusters/plan_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "perception/free_space/clusters/cell_labels.h"
#include "tools/simulate/scene/scene_file.h"

namespace sgraphs {
namespace {

// A rectangle on the floor.
struct Footprint {
  Eigen::Vector2d center, axis, half;
  bool holds(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d d = p - center;
    return std::abs(d.dot(axis)) <= half.x() && std::abs(d.x() * axis.y() - d.y() * axis.x()) <= half.y();
  }
};

Footprint footprintOf(const simulate::Wall& wall) {
  return {
      0.5 * (wall.a + wall.b), (wall.b - wall.a).normalized(), {0.5 * wall.length(), 0.5 * wall.thickness_m}};
}

class Plan {
 public:
  Plan(const simulate::Scene& scene, int floor) : scene_(scene) {
    const double z_m = scene.floors_z_m.at(static_cast<size_t>(floor));
    for (const auto& wall : scene.walls)
      if (wall.z_min_m < z_m + 1.5 && wall.z_max_m > z_m + 0.5) walls_.push_back(footprintOf(wall));
    for (const auto& door : scene.doorways) {
      if (door.floor != floor) continue;
      for (const Footprint& wall : walls_)
        if (Footprint{wall.center, wall.axis, wall.half + Eigen::Vector2d(0, 0.05)}.holds(door.xyz.head<2>()))
          doors_.push_back({door.xyz.head<2>(), wall.axis, {0.5 * door.width_m, wall.half.y() + 0.02}});
    }
    for (const auto& box : scene.boxes)
      if (box.z_min_m < z_m + 1.5 && box.z_max_m > z_m + 0.1)
        things_.push_back({box.center, {std::cos(box.yaw_rad), std::sin(box.yaw_rad)}, 0.5 * box.size});
    for (const auto& room : scene.rooms)
      if (room.floor == floor) rooms_.push_back(room.polygon);
    for (const auto& column : scene.columns)
      if (column.z_min_m < z_m + 1.5 && column.z_max_m > z_m + 0.5) columns_.push_back(column);
  }
  bool inDoor(const Eigen::Vector2d& p) const { return any(doors_, p); }
  bool inWall(const Eigen::Vector2d& p) const { return any(walls_, p) && !inDoor(p); }
  bool inThing(const Eigen::Vector2d& p) const {
    return any(things_, p) || std::any_of(columns_.begin(), columns_.end(), [&p](const auto& c) {
             return (p - c.center).norm() <= c.radius_m;
           });
  }
  bool inRoom(const Eigen::Vector2d& p) const {
    return std::any_of(rooms_.begin(), rooms_.end(), [&p](const auto& polygon) {
      bool in = false;
      for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const Eigen::Vector2d &a = polygon[i], &b = polygon[j];
        if ((a.y() > p.y()) != (b.y() > p.y()) &&
            p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
          in = !in;
      }
      return in;
    });
  }
  // Polygons of parts of one hall leave gaps of less than a cell.
  bool nearRoom(const Eigen::Vector2d& p) const {
    for (int k = 0; k < 4; ++k)
      if (inRoom(p + 0.05 * Eigen::Vector2d(k % 2 * 2 - 1, k / 2 * 2 - 1))) return true;
    return false;
  }
  const std::vector<std::vector<Eigen::Vector2d>>& rooms() const { return rooms_; }

 private:
  static bool any(const std::vector<Footprint>& shapes, const Eigen::Vector2d& p) {
    return std::any_of(shapes.begin(), shapes.end(), [&p](const Footprint& f) { return f.holds(p); });
  }
  const simulate::Scene& scene_;
  std::vector<Footprint> walls_, doors_, things_;
  std::vector<simulate::Column> columns_;
  std::vector<std::vector<Eigen::Vector2d>> rooms_;
};

StoreyGrid emptyGrid(const Plan& plan, const PlanView& view) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
  for (const auto& polygon : plan.rooms())
    for (const Eigen::Vector2d& corner : polygon) {
      low = low.cwiseMin(toMap(corner, view.yaw_rad));
      high = high.cwiseMax(toMap(corner, view.yaw_rad));
    }
  StoreyGrid grid;
  grid.floor = FloorId{view.floor};
  grid.cell_m = view.cell_m;
  grid.origin_map = view.cell_m * ((low / view.cell_m).array().floor() - 4).matrix();
  grid.width = static_cast<int>((high.x() - grid.origin_map.x()) / view.cell_m) + 5;
  grid.height = static_cast<int>((high.y() - grid.origin_map.y()) / view.cell_m) + 5;
  grid.state.assign(static_cast<size_t>(grid.width) * static_cast<size_t>(grid.height), CellState::kUnknown);
  return grid;
}

bool besideFree(const StoreyGrid& grid, int x, int y) {
  return std::any_of(kCellSteps.begin(), kCellSteps.end(),
                     [&](const CellStep& s) { return stateAt(grid, x + s.x, y + s.y) == CellState::kFree; });
}

// Cells at walls are wrong by one now and then, either way.
void addNoise(StoreyGrid& grid, double share, std::mt19937& random) {
  const StoreyGrid clean = grid;
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const double dice = static_cast<double>(random()) / 4294967296.0;
      CellState& state = grid.state[grid.index(x, y)];
      bool by_obstacle = false;
      for (size_t k = 0; k < 4; ++k)
        by_obstacle |= stateAt(clean, x + kCellSteps[k].x, y + kCellSteps[k].y) == CellState::kObstacle;
      if (dice < share && state == CellState::kFree && by_obstacle) state = CellState::kObstacle;
      if (dice < share && state == CellState::kObstacle && by_obstacle && besideFree(clean, x, y) && x > 1 &&
          y > 1 && dice < 0.3 * share)
        state = CellState::kFree;
    }
}

// Distances along one line of squared distances: lower envelope of parabolas.
void envelope(std::vector<double>& f) {
  const size_t n = f.size();
  std::vector<size_t> v(n);
  std::vector<double> z(n + 1), d(n);
  size_t k = 0;
  z[0] = -1e18;
  z[1] = 1e18;
  const auto meet = [&f](size_t q, size_t p) {
    const auto a = static_cast<double>(q), b = static_cast<double>(p);
    return ((f[q] + a * a) - (f[p] + b * b)) / (2 * (a - b));
  };
  for (size_t q = 1; q < n; ++q) {
    double s = meet(q, v[k]);
    while (s <= z[k]) s = meet(q, v[--k]);
    v[++k] = q;
    z[k] = s;
    z[k + 1] = 1e18;
  }
  k = 0;
  for (size_t q = 0; q < n; ++q) {
    while (z[k + 1] < static_cast<double>(q)) ++k;
    const double step = static_cast<double>(q) - static_cast<double>(v[k]);
    d[q] = step * step + f[v[k]];
  }
  f = d;
}

}  // namespace

simulate::Scene shippedScene(const std::string& name) {
  return simulate::loadScene(std::string(SGRAPHS_SOURCE_DIR) + "/config/scenes/" + name + "/plan.json");
}

Eigen::Vector2d toMap(const Eigen::Vector2d& p, double yaw_rad) {
  return Eigen::Rotation2Dd(yaw_rad) * p;
}

PlanGrids planGrids(const simulate::Scene& scene, const PlanView& view) {
  const Plan plan(scene, view.floor);
  PlanGrids grids;
  StoreyGrid& rooms = grids.rooms = emptyGrid(plan, view);
  std::vector<uint8_t> wall(rooms.state.size(), 0), thing(rooms.state.size(), 0);
  for (int y = 0; y < rooms.height; ++y)
    for (int x = 0; x < rooms.width; ++x) {
      const size_t i = rooms.index(x, y);
      const Eigen::Vector2d center = toMap(rooms.center(x, y), -view.yaw_rad);
      for (int k = 0; k < 5; ++k) {
        // The four corners, and the middle.
        const int column = k % 2, row = k / 2;
        const Eigen::Vector2d corner(k == 4 ? 0 : column - 0.5, k == 4 ? 0 : row - 0.5);
        const Eigen::Vector2d p = toMap(rooms.center(x, y) + 0.98 * rooms.cell_m * corner, -view.yaw_rad);
        wall[i] |= plan.inWall(p) ? 1 : 0;
        thing[i] |= plan.inThing(p) ? 1 : 0;
      }
      if (wall[i] || (view.seen && !view.seen(center))) continue;
      if (plan.nearRoom(center) || plan.inDoor(center)) rooms.state[i] = CellState::kFree;
    }
  for (int y = 0; y < rooms.height; ++y)
    for (int x = 0; x < rooms.width; ++x)
      if (wall[rooms.index(x, y)] && besideFree(rooms, x, y))
        rooms.state[rooms.index(x, y)] = CellState::kObstacle;
  std::mt19937 random(view.seed);
  addNoise(rooms, view.noise, random);
  grids.navigation = rooms;
  for (size_t i = 0; i < thing.size(); ++i)
    if (thing[i] && rooms.state[i] == CellState::kFree) grids.navigation.state[i] = CellState::kObstacle;
  fillClearance(grids.rooms, view.reach_m);
  fillClearance(grids.navigation, view.reach_m);
  return grids;
}

void fillClearance(StoreyGrid& grid, double reach_m) {
  const auto w = static_cast<size_t>(grid.width), h = static_cast<size_t>(grid.height);
  std::vector<double> squared(w * h);
  // What is outside of the grid is not free either: cells at its edge are not, by the way grids are made.
  for (size_t i = 0; i < squared.size(); ++i) squared[i] = grid.state[i] == CellState::kFree ? 1e12 : 0;
  std::vector<double> line(w);
  for (size_t y = 0; y < h; ++y) {
    std::copy_n(squared.begin() + static_cast<std::ptrdiff_t>(y * w), w, line.begin());
    envelope(line);
    std::copy(line.begin(), line.end(), squared.begin() + static_cast<std::ptrdiff_t>(y * w));
  }
  line.resize(h);
  for (size_t x = 0; x < w; ++x) {
    for (size_t y = 0; y < h; ++y) line[y] = squared[y * w + x];
    envelope(line);
    for (size_t y = 0; y < h; ++y) squared[y * w + x] = line[y];
  }
  grid.clearance_m.resize(squared.size());
  for (size_t i = 0; i < squared.size(); ++i)
    grid.clearance_m[i] = static_cast<float>(std::min(reach_m, std::sqrt(squared[i]) * grid.cell_m));
}

StoreyGrid gridOf(const std::vector<std::string>& rows, int repeat) {
  StoreyGrid grid;
  grid.floor = FloorId{0};
  grid.width = repeat * static_cast<int>(rows.front().size());
  grid.height = repeat * static_cast<int>(rows.size());
  grid.state.assign(static_cast<size_t>(grid.width) * static_cast<size_t>(grid.height), CellState::kUnknown);
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const char c = rows[rows.size() - 1 - static_cast<size_t>(y / repeat)][static_cast<size_t>(x / repeat)];
      grid.state[grid.index(x, y)] = c == '.'   ? CellState::kFree
                                     : c == '#' ? CellState::kObstacle
                                                : CellState::kUnknown;
    }
  fillClearance(grid, 5.0);
  return grid;
}

}  // namespace sgraphs
