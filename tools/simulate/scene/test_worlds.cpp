#include "tools/simulate/scene/test_worlds.h"

namespace sgraphs::simulate {
namespace {
constexpr double kThickness_m = 0.1;
}

Scene makeBoxRoom(double size_x_m, double size_y_m, double height_m) {
  Scene scene;
  scene.name = "box room";
  // Centre lines lie half a thickness outside the inner faces.
  const double h = 0.5 * kThickness_m, x = size_x_m + h, y = size_y_m + h;
  const Eigen::Vector2d corners[] = {{-h, -h}, {x, -h}, {x, y}, {-h, y}};
  for (size_t i = 0; i < 4; ++i)
    scene.walls.push_back({corners[i], corners[(i + 1) % 4], kThickness_m, 0, height_m});
  scene.rooms.push_back({"R1", 0, {{0, 0}, {size_x_m, 0}, {size_x_m, size_y_m}, {0, size_y_m}}});
  scene.path.waypoints = {{{0.5 * size_x_m, 0.5 * size_y_m}, 0}};
  return scene;
}

Scene makeCorridor(double length_m, double width_m, double height_m) {
  Scene scene = makeBoxRoom(length_m, width_m, height_m);
  scene.name = "corridor";
  scene.rooms.front().id = "C_1";
  return scene;
}

Scene makeTwoStoreys() {
  Scene scene = makeBoxRoom(9, 5);
  scene.name = "two storeys";
  scene.floors_z_m = {0, 3};
  const std::vector<Wall> ground = scene.walls;
  for (Wall wall : ground) {
    wall.z_min_m += 3;
    wall.z_max_m += 3;
    scene.walls.push_back(wall);
  }
  scene.stairs.push_back({{1.5, 1}, {6.3, 1}, 1.2, 0, 3, 16});
  scene.path.waypoints = {{{0.8, 3.8}, 0},  {{0.8, 1}, 0},    {{1.5, 1}, 0, 0},
                          {{6.3, 1}, 0, 3}, {{7.8, 1}, 0, 3}, {{7.8, 3.8}, 0, 3}};
  return scene;
}

LidarScan simulateScan(const SimulatedWorld& world, const SE3& T_building_lidar, const SensorModel& model,
                       uint64_t seed) {
  return simulateMovingScan(world, T_building_lidar, Vector6d::Zero(), model, seed);
}

LidarScan simulateMovingScan(const SimulatedWorld& world, const SE3& T_building_lidar_begin,
                             const Vector6d& twist_lidar, const SensorModel& model, uint64_t seed) {
  const Duration revolution = Duration::fromSeconds(60.0 / model.rpm);
  const auto trajectory =
      Trajectory::constantTwist(world.scene.start, revolution, T_building_lidar_begin, twist_lidar);
  return SensorSimulator(world.caster, trajectory, SE3(), model, seed).scan(0);
}

}  // namespace sgraphs::simulate
