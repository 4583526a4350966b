#pragma once

#include <string>
#include <vector>

#include "tools/simulate/building/triangle_mesh.h"

namespace sgraphs::simulate {

struct SdfSurfaces {
  TriangleMesh mesh;
  std::vector<std::string> warnings;  // one line each, of what was left out
};

// The boxes, cylinders, planes and meshes of an SDF file (sdformat.org) at the poses of their models and
// links: of each link what is seen, its visuals; its collisions where it has no visual, or where the mesh of
// a visual is missing. Meshes are looked for beside the file. Throws Error naming the element that is wrong.
SdfSurfaces readSdf(const std::string& path);

}  // namespace sgraphs::simulate
