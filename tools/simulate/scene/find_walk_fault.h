#pragma once

#include <optional>
#include <string>

#include "tools/simulate/scene/scene.h"

namespace sgraphs::simulate {

// Why the path cannot be walked in this building, or nothing: a waypoint in the air, a rise too steep, or
// something within the clearance, looked at in the band of heights that the body and its LiDAR sweep at each
// place. Steps under the feet and slabs under the feet or overhead are in nobody's way. Meshes are not looked
// at. The building itself has no fault.
std::optional<std::string> findWalkFault(const Scene& scene);

}  // namespace sgraphs::simulate
