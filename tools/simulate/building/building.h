#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/simulate/building/triangle_mesh.h"
#include "tools/simulate/scene/scene.h"

namespace sgraphs::simulate {

// Hole in a wall as the wall sees it.
struct Opening {
  double begin_m = 0;  // along the wall from a
  double end_m = 0;
  double z_min_m = 0;
  double z_max_m = 0;
  bool glazed = false;
};

// The doorway's or window's opening in this wall; nothing if it does not stand on the wall's centre line
// (within half a thickness) or not within its length and height.
std::optional<Opening> openingOf(const Doorway& doorway, const Wall& wall);
std::optional<Opening> openingOf(const Window& window, const Wall& wall);

// Doorways first, then windows, each in the scene's order.
std::vector<Opening> openingsOf(const Scene& scene, const Wall& wall);

// Rectangular part of a wall beside, below or above its openings: an upright box.
struct WallPart {
  double begin_m = 0;
  double end_m = 0;
  double z_min_m = 0;
  double z_max_m = 0;
};

// The wall without its openings, which may overlap.
std::vector<WallPart> wallParts(const Wall& wall, std::vector<Opening> openings);

// Upright box that fills this part of the wall.
Box boxOf(const Wall& wall, const WallPart& part);

// A floor and a ceiling per storey over the walls' bounding rectangle, for scenes that give none; over
// flights of stairs they are cut out, over the rectangle along x and y around the flight. Where walls reach
// the next floor's slab it is their ceiling.
std::vector<Slab> defaultSlabs(const Scene& scene);

// The scene's slabs, or the default ones.
std::vector<Slab> slabsOf(const Scene& scene);

// Every opaque surface of the building, as closed bodies. People are not part of it.
TriangleMesh buildMesh(const Scene& scene);

// Its panes of glass (glass walls, glazed windows), as single sheets in the walls' centre planes. They are
// kept out of buildMesh, and so of the truth's mesh.ply: a LiDAR hardly sees them.
TriangleMesh buildGlass(const Scene& scene);

}  // namespace sgraphs::simulate
