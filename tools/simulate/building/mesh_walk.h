#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/simulate/building/ray_caster.h"
#include "tools/simulate/walk/walk.h"

namespace sgraphs::simulate {

// What a walk meets in a mesh, found by rays: nothing is known of it but its surfaces.

// Heights of the level surfaces on the vertical line through xy with room to walk above them, lowest first;
// looked for between the two heights.
std::vector<double> walkingSurfaces(const RayCaster& mesh, const Eigen::Vector2d& xy, double z_min_m,
                                    double z_max_m);

// Why nobody can walk so: the waypoint or the stretch that goes through the mesh or comes closer to it than
// the path's clearance; or nothing. `top_m`: height of the LiDAR over the walking surface.
std::optional<std::string> meshWalkFault(const RayCaster& mesh, const WalkPath& path, double floor_z_m,
                                         double top_m);

}  // namespace sgraphs::simulate
