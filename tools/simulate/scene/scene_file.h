#pragma once

#include <string>

#include "tools/simulate/scene/scene.h"

namespace sgraphs::simulate {

// Reads and checks a plan (config/scenes/README.md). Throws Error naming file and line for broken JSON, or
// the item that is wrong.
Scene loadScene(const std::string& path);

// The same from text; `where` stands for the file in errors.
Scene parseScene(const std::string& text, const std::string& where);

// The plan as the truth holds it: what stands still in the building, its rooms, and T_body_lidar; no path,
// people, slabs, meshes or models.
void writePlan(const std::string& path, const Scene& scene);

}  // namespace sgraphs::simulate
