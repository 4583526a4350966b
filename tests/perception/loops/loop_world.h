#pragma once

#include <string>
#include <vector>

#include "perception/loops/loop_finder.h"
#include "tools/simulate/scene/test_worlds.h"

namespace sgraphs::test {

// Keyframes of a walk with their true poses: a cloud of three revolutions each, seen within 0.6 m of path.
struct LoopWalk {
  std::vector<Keyframe> keyframes;  // by id, from 0; T_odom_body is the truth
  std::vector<SE3> T_building_body;
};

// A keyframe seen from a pose, the earlier revolutions from behind it.
Keyframe keyframeAt(const simulate::SimulatedWorld& world, const SE3& T_building_body, int64_t id,
                    uint64_t seed);

// One keyframe per metre or 35 degrees of the scene's path, up to a length.
LoopWalk walkThrough(const simulate::Scene& scene, uint64_t seed, double max_path_m = 1e9);
// Of a plan in config/scenes.
simulate::Scene shippedScene(const std::string& name);

// A pose on the floor's plane, of a body 0.52 m above it.
SE3 bodyAt(double x_m, double y_m, double heading_rad, double floor_z_m = 0);

// How a map errs: as odometry whose headings drift and whose distances are off.
struct MapDrift {
  double yaw_rad_per_m = 0;
  double scale = 0;
  bool registered = true;  // what the odometry claims to be
};

struct LoopOutcome {
  std::vector<LoopClosure> accepted;
  std::vector<LoopId> withdrawn;
  bool searching = false;      // after the last round
  double largest_drift_m = 0;  // of a keyframe's place in map
  int false_loops = 0;  // more than 0.3 m or 5 degrees off the truth, or between storeys; not withdrawn
  double worst_m = 0;   // of the others
};

// Feeds the walk round by round, with a map that nothing corrects, and a few idle rounds. `floors`: by
// keyframe; empty: one storey. The map tells a keyframe's storey `late_rounds` after the keyframe, and until
// then the first one's.
LoopOutcome findLoops(const LoopWalk& walk, const MapDrift& drift, const LoopsConfig& config = {},
                      const std::vector<FloorId>& floors = {}, size_t late_rounds = 1);

}  // namespace sgraphs::test
