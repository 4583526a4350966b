#pragma once

#include "tools/simulate/building/building.h"
#include "tools/simulate/sensor/sensor_simulator.h"

namespace sgraphs::simulate {

// Small buildings for tests, made in code: no files. Each is a Scene whose path may be replaced.

// One room without door: the inner faces of its walls lie at x = 0 and size_x, y = 0 and size_y, z = 0 and
// height.
Scene makeBoxRoom(double size_x_m, double size_y_m, double height_m = 2.8);

// A corridor along x, closed at both ends: inner faces at y = 0 and width, x = 0 and length.
Scene makeCorridor(double length_m, double width_m = 2.0, double height_m = 2.8);

// A hall of 9 x 5 m on two storeys, floors at z = 0 and 3, walls 2.8 m high, with a flight of 16 steps along
// x from (1.5, 1) to (6.3, 1), 1.2 m wide, and a walk up.
Scene makeTwoStoreys();

// A building ready to be measured; moves, but does not copy.
struct SimulatedWorld {
  explicit SimulatedWorld(const Scene& from)
      : scene(from), mesh(buildMesh(scene)), caster(mesh, buildGlass(scene)) {}

  Scene scene;
  TriangleMesh mesh;
  RayCaster caster;
};

// One revolution from a sensor that stands still.
LidarScan simulateScan(const SimulatedWorld& world, const SE3& T_building_lidar,
                       const SensorModel& model = SensorModel::noiseFree(), uint64_t seed = 0);

// One revolution from a sensor that moves with a constant twist (in lidar: [m/s], [rad/s]);
// T_building_lidar_begin holds at the first firing.
LidarScan simulateMovingScan(const SimulatedWorld& world, const SE3& T_building_lidar_begin,
                             const Vector6d& twist_lidar, const SensorModel& model = SensorModel::noiseFree(),
                             uint64_t seed = 0);

}  // namespace sgraphs::simulate
