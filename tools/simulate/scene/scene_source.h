#pragma once

#include <string>
#include <vector>

#include "tools/simulate/building/triangle_mesh.h"
#include "tools/simulate/scene/scene.h"

namespace sgraphs::simulate {

// What a command line says about a scene.
struct SceneRequest {
  std::string scene;                   // as findScene takes it (find_scene.h)
  std::string waypoints;               // file with a walk; empty: the plan's own
  std::vector<std::string> overrides;  // as overridePlan takes them
};

struct SceneSource {
  Scene scene;
  TriangleMesh imported;  // the scene's meshes, in the building's frame
  std::string digest;     // of all that was read: file, walk, overrides, meshes
  std::vector<std::string> warnings;
};

// Reads a scene with its meshes and checks the walk against them. A mesh by itself is a scene once it is
// given waypoints: its floor is the lowest walking surface under the first of them, or, where there is none,
// a ground that is laid under the mesh. Throws Error or UsageError.
SceneSource openScene(const SceneRequest& request);

}  // namespace sgraphs::simulate
