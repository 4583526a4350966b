#pragma once

#include <optional>
#include <string>

#include "tools/simulate/scene/scene.h"

namespace sgraphs::simulate {

// Why the scene cannot be: what is wrong with which item, or nothing. Checks sizes, that doorways stand on
// walls, that waypoints and the walk keep their clearance from walls and furniture.
std::optional<std::string> findFault(const Scene& scene);

}  // namespace sgraphs::simulate
