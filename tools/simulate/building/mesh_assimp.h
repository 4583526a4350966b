#pragma once

#include <string>

#include "tools/simulate/building/triangle_mesh.h"

namespace sgraphs::simulate {

// The triangles of a PLY, OBJ, STL or DAE file, with the transforms of all nodes applied. DAE files say their
// unit and upward axis: they come out in metres with z up. The others come out as they are written. Points
// and lines are left out. Throws Error if the file cannot be read.
TriangleMesh readMeshFile(const std::string& path);

}  // namespace sgraphs::simulate
