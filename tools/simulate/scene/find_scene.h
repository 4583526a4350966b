#pragma once

#include <string>

namespace sgraphs::simulate {

// The path ends like a mesh: .ply, .obj, .stl, .dae or .sdf, in any case.
bool isMeshPath(const std::string& path);

// Path of the file that SCENE of the command line names: a plan.json, a folder that holds one, a mesh, or the
// name of a scene shipped in config/scenes. Shipped scenes are looked for in $SGRAPHS_SCENES, else beside the
// installed program (share/sgraphs/scenes), else in the source tree. Throws UsageError that names the known
// scenes.
std::string findScene(const std::string& scene);

}  // namespace sgraphs::simulate
