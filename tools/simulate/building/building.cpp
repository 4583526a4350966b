#include "tools/simulate/building/building.h"

#include <algorithm>
#include <cmath>

namespace sgraphs::simulate {
namespace {

// Reflectivities on the VLP-16's scale: painted plaster, wood, carpet.
constexpr uint8_t kWallReflectivity = 55;
constexpr uint8_t kBoxReflectivity = 35;
constexpr uint8_t kSlabReflectivity = 20;
constexpr double kSlabThickness_m = 0.1;
constexpr double kTolerance_m = 1e-6;

Eigen::Vector2d direction(const Wall& wall) {
  return (wall.b - wall.a) / wall.length();
}

void addBox(TriangleMesh& mesh, const Box& box, uint8_t reflectivity) {
  mesh.addBox({box.center.x(), box.center.y(), 0.5 * (box.z_min_m + box.z_max_m)},
              {box.size.x(), box.size.y(), box.z_max_m - box.z_min_m}, box.yaw_rad, reflectivity);
}

}  // namespace

std::optional<Opening> openingOf(const Doorway& doorway, const Wall& wall) {
  const Eigen::Vector2d u = direction(wall), d = doorway.xyz.head<2>() - wall.a;
  const double along = u.dot(d), across = std::abs(u.x() * d.y() - u.y() * d.x());
  const Opening opening{along - 0.5 * doorway.width_m, along + 0.5 * doorway.width_m, doorway.xyz.z(),
                        doorway.xyz.z() + doorway.height_m};
  if (across > 0.5 * wall.thickness_m || opening.begin_m < -kTolerance_m ||
      opening.end_m > wall.length() + kTolerance_m || opening.z_min_m < wall.z_min_m - kTolerance_m ||
      opening.z_max_m > wall.z_max_m + kTolerance_m)
    return std::nullopt;
  return opening;
}

std::vector<WallPart> wallParts(const Wall& wall, const std::vector<Doorway>& doorways) {
  std::vector<Opening> openings;
  std::vector<double> cuts{0, wall.length()};
  for (const Doorway& doorway : doorways)
    if (const auto opening = openingOf(doorway, wall)) {
      openings.push_back(*opening);
      cuts.push_back(std::clamp(opening->begin_m, 0.0, wall.length()));
      cuts.push_back(std::clamp(opening->end_m, 0.0, wall.length()));
    }
  std::sort(cuts.begin(), cuts.end());
  std::sort(openings.begin(), openings.end(),
            [](const Opening& a, const Opening& b) { return a.z_min_m < b.z_min_m; });
  std::vector<WallPart> parts;
  for (size_t i = 0; i + 1 < cuts.size(); ++i) {
    if (cuts[i + 1] - cuts[i] < kTolerance_m) continue;
    const double middle = 0.5 * (cuts[i] + cuts[i + 1]);
    // From the bottom upwards: solid up to each opening over this stretch.
    double z = wall.z_min_m;
    for (const Opening& opening : openings) {
      if (middle < opening.begin_m || middle > opening.end_m) continue;
      if (opening.z_min_m > z + kTolerance_m) parts.push_back({cuts[i], cuts[i + 1], z, opening.z_min_m});
      z = std::max(z, opening.z_max_m);
    }
    if (wall.z_max_m > z + kTolerance_m) parts.push_back({cuts[i], cuts[i + 1], z, wall.z_max_m});
  }
  return parts;
}

Box boxOf(const Wall& wall, const WallPart& part) {
  const Eigen::Vector2d u = direction(wall);
  Box box;
  box.center = wall.a + 0.5 * (part.begin_m + part.end_m) * u;
  box.size = {part.end_m - part.begin_m, wall.thickness_m};
  box.z_min_m = part.z_min_m;
  box.z_max_m = part.z_max_m;
  box.yaw_rad = std::atan2(u.y(), u.x());
  return box;
}

std::vector<Slab> defaultSlabs(const Scene& scene) {
  Slab outline;
  outline.min.setConstant(1e9);
  outline.max.setConstant(-1e9);
  for (const Wall& wall : scene.walls) {
    const Eigen::Vector2d u = direction(wall), half = 0.5 * wall.thickness_m * Eigen::Vector2d(-u.y(), u.x());
    for (const Eigen::Vector2d& end : {wall.a, wall.b}) {
      outline.min = outline.min.cwiseMin(end + half).cwiseMin(end - half);
      outline.max = outline.max.cwiseMax(end + half).cwiseMax(end - half);
    }
  }
  std::vector<Slab> slabs;
  for (const double floor_z : scene.floors_z_m) {
    double top = floor_z;
    for (const Wall& wall : scene.walls)
      if (wall.z_min_m <= floor_z + 0.5 && wall.z_max_m > floor_z) top = std::max(top, wall.z_max_m);
    slabs.push_back({outline.min, outline.max, floor_z - kSlabThickness_m, floor_z});
    if (top > floor_z) slabs.push_back({outline.min, outline.max, top, top + kSlabThickness_m});
  }
  return slabs;
}

TriangleMesh buildMesh(const Scene& scene) {
  TriangleMesh mesh;
  for (const Wall& wall : scene.walls)
    for (const WallPart& part : wallParts(wall, scene.doorways))
      addBox(mesh, boxOf(wall, part), kWallReflectivity);
  for (const Box& box : scene.boxes) addBox(mesh, box, kBoxReflectivity);
  for (const Slab& slab : scene.slabs.empty() ? defaultSlabs(scene) : scene.slabs) {
    const Eigen::Vector2d center = 0.5 * (slab.min + slab.max), size = slab.max - slab.min;
    mesh.addBox({center.x(), center.y(), 0.5 * (slab.z_min_m + slab.z_max_m)},
                {size.x(), size.y(), slab.z_max_m - slab.z_min_m}, 0, kSlabReflectivity);
  }
  return mesh;
}

}  // namespace sgraphs::simulate
