#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/simulate/building/triangle_mesh.h"
#include "tools/simulate/scene/scene.h"

namespace sgraphs::simulate {

// Doorway of a wall as the wall sees it.
struct Opening {
  double begin_m = 0;  // along the wall from a
  double end_m = 0;
  double z_min_m = 0;
  double z_max_m = 0;
};

// The doorway's opening in this wall; nothing if it does not stand on the wall's centre line (within half a
// thickness) or not within its length and height.
std::optional<Opening> openingOf(const Doorway& doorway, const Wall& wall);

// Rectangular part of a wall beside, below or above its openings: an upright box.
struct WallPart {
  double begin_m = 0;
  double end_m = 0;
  double z_min_m = 0;
  double z_max_m = 0;
};

// The wall without its openings, which may overlap.
std::vector<WallPart> wallParts(const Wall& wall, const std::vector<Doorway>& doorways);

// Upright box that fills this part of the wall.
Box boxOf(const Wall& wall, const WallPart& part);

// A floor and a ceiling per storey over the walls' bounding rectangle, for scenes that give none.
std::vector<Slab> defaultSlabs(const Scene& scene);

// Every surface of the building, as closed boxes.
TriangleMesh buildMesh(const Scene& scene);

}  // namespace sgraphs::simulate
