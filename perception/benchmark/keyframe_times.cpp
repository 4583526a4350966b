#include "perception/benchmark/keyframe_times.h"

#include <utility>

#include "perception/odometry/odometry.h"
#include "tools/simulate/scene/find_scene.h"
#include "tools/simulate/scene/scene_file.h"
#include "tools/simulate/scene/test_worlds.h"

namespace sgraphs {

std::vector<Keyframe> keyframesOfScene(const std::string& name) {
  const simulate::Scene scene = simulate::loadScene(simulate::findScene(name));
  const simulate::SimulatedWorld world(scene);
  const simulate::Trajectory truth = simulate::walkAlong(scene.path, scene.start, scene.floors_z_m.front());
  const simulate::SensorSimulator sensor(world.caster, truth, scene.T_body_lidar, scene.sensor, 1);
  Odometry odometry(OdometryConfig{}, OdometryMode::kLidar, scene.T_body_lidar);
  std::vector<Keyframe> keyframes;
  for (int64_t i = 0; i < sensor.numScans(); ++i)
    if (odometry.step(sensor.scan(i), {}))
      if (auto keyframe = odometry.takeKeyframe()) keyframes.push_back(std::move(*keyframe));
  return keyframes;
}

}  // namespace sgraphs
