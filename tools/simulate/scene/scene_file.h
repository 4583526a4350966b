#pragma once

#include <string>

#include "tools/simulate/scene/scene.h"

namespace sgraphs::simulate {

// Path of the plan that SCENE of the command line names: a plan.json, a folder that holds one, or the name of
// a scene shipped in config/scenes. Shipped scenes are looked for in $SGRAPHS_SCENES, else beside the
// installed program (share/sgraphs/scenes), else in the source tree. Throws UsageError that names the known
// scenes.
std::string findScene(const std::string& scene);

// Reads and checks a plan (config/scenes/README.md). Throws Error naming file and line for broken JSON, or
// the item that is wrong.
Scene loadScene(const std::string& path);

// The same from text; `where` stands for the file in errors.
Scene parseScene(const std::string& text, const std::string& where);

// The plan as the truth holds it: what stands still in the building, its rooms, and T_body_lidar; no path,
// people, slabs, meshes or models.
void writePlan(const std::string& path, const Scene& scene);

}  // namespace sgraphs::simulate
