#pragma once

#include <string>
#include <vector>

#include "tools/simulate/building/triangle_mesh.h"
#include "tools/simulate/scene/scene.h"

namespace sgraphs::simulate {

struct ImportedMesh {
  TriangleMesh mesh;                  // in the building's frame [m]
  std::vector<std::string> warnings;  // one line each
};

// Reads a mesh and puts it where the plan wants it. Throws Error if it is missing, unreadable, of an unknown
// kind, without triangles, not finite or of a size that no building has; a mesh with holes is used and
// warned of.
ImportedMesh importMesh(const MeshFile& file);

}  // namespace sgraphs::simulate
