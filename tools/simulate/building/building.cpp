#include "tools/simulate/building/building.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sgraphs::simulate {
namespace {

// Reflectivities on the VLP-16's scale: painted plaster, wood, carpet.
constexpr uint8_t kWallReflectivity = 55;
constexpr uint8_t kBoxReflectivity = 35;
constexpr uint8_t kSlabReflectivity = 20;
constexpr uint8_t kStairsReflectivity = 30;
constexpr uint8_t kGlassReflectivity = 5;
constexpr int kColumnSides = 24;
constexpr double kSlabThickness_m = 0.1;
constexpr double kTolerance_m = 1e-6;

Eigen::Vector2d direction(const Wall& wall) {
  return (wall.b - wall.a) / wall.length();
}

void addBox(TriangleMesh& mesh, const Box& box, uint8_t reflectivity) {
  mesh.addBox({box.center.x(), box.center.y(), 0.5 * (box.z_min_m + box.z_max_m)},
              {box.size.x(), box.size.y(), box.z_max_m - box.z_min_m}, box.yaw_rad, reflectivity);
}

void addSlab(TriangleMesh& mesh, const Slab& slab) {
  const Eigen::Vector2d center = 0.5 * (slab.min + slab.max), size = slab.max - slab.min;
  mesh.addBox({center.x(), center.y(), 0.5 * (slab.z_min_m + slab.z_max_m)},
              {size.x(), size.y(), slab.z_max_m - slab.z_min_m}, 0, kSlabReflectivity);
}

// One closed body: treads, risers, sides in columns under the treads, bottom and back.
void addStairs(TriangleMesh& mesh, const Stairs& stairs) {
  const Eigen::Vector2d run = stairs.top - stairs.foot;
  const Eigen::Vector2d across = 0.5 * stairs.width_m * Eigen::Vector2d(-run.y(), run.x()) / run.norm();
  const double rise = stairs.z_max_m - stairs.z_min_m;
  // Left and right edge of the flight `step` steps on, at the height of step number `level`.
  const auto left = [&](int step, int level) {
    const Eigen::Vector2d xy = stairs.foot + run * step / stairs.steps + across;
    return Eigen::Vector3d(xy.x(), xy.y(), stairs.z_min_m + rise * level / stairs.steps);
  };
  const auto right = [&](int step, int level) {
    return Eigen::Vector3d(left(step, level) - Eigen::Vector3d(2 * across.x(), 2 * across.y(), 0));
  };
  for (int k = 0; k < stairs.steps; ++k) {
    const int n = k + 1;
    mesh.addQuad({left(k, k), right(k, k), right(k, n), left(k, n)}, kStairsReflectivity);
    mesh.addQuad({left(k, n), right(k, n), right(n, n), left(n, n)}, kStairsReflectivity);
    mesh.addQuad({right(k, 0), right(n, 0), right(n, n), right(k, n)}, kStairsReflectivity);
    mesh.addQuad({left(n, 0), left(k, 0), left(k, n), left(n, n)}, kStairsReflectivity);
  }
  const int n = stairs.steps;
  mesh.addQuad({right(n, 0), left(n, 0), left(n, n), right(n, n)}, kStairsReflectivity);
  mesh.addQuad({left(0, 0), left(n, 0), right(n, 0), right(0, 0)}, kStairsReflectivity);
}

// A sheet in the wall's centre plane.
void addPane(TriangleMesh& mesh, const Wall& wall, double begin_m, double end_m, double z_min_m,
             double z_max_m) {
  const Eigen::Vector2d a = wall.a + begin_m * direction(wall), b = wall.a + end_m * direction(wall);
  mesh.addQuad({Eigen::Vector3d(a.x(), a.y(), z_min_m), Eigen::Vector3d(b.x(), b.y(), z_min_m),
                Eigen::Vector3d(b.x(), b.y(), z_max_m), Eigen::Vector3d(a.x(), a.y(), z_max_m)},
               kGlassReflectivity);
}

// The opening of an item whose lower edge has its middle at xyz.
std::optional<Opening> openingAt(const Eigen::Vector3d& xyz, double width_m, double height_m,
                                 const Wall& wall) {
  const Eigen::Vector2d u = direction(wall), d = xyz.head<2>() - wall.a;
  const double along = u.dot(d), across = std::abs(u.x() * d.y() - u.y() * d.x());
  const Opening opening{along - 0.5 * width_m, along + 0.5 * width_m, xyz.z(), xyz.z() + height_m, false};
  if (across > 0.5 * wall.thickness_m || opening.begin_m < -kTolerance_m ||
      opening.end_m > wall.length() + kTolerance_m || opening.z_min_m < wall.z_min_m - kTolerance_m ||
      opening.z_max_m > wall.z_max_m + kTolerance_m)
    return std::nullopt;
  return opening;
}

// Rectangle along x and y.
struct Rectangle {
  Eigen::Vector2d min = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d max = Eigen::Vector2d::Constant(-1e9);

  void include(const Eigen::Vector2d& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
};

// Rectangle around a strip of this width from a to b.
void includeStrip(Rectangle& around, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double width_m) {
  const Eigen::Vector2d u = (b - a).normalized(), half = 0.5 * width_m * Eigen::Vector2d(-u.y(), u.x());
  for (const Eigen::Vector2d& end : {a, b}) {
    around.include(end + half);
    around.include(end - half);
  }
}

// The slab without the part over the rectangle, in up to four pieces.
void cutOut(const Slab& slab, const Rectangle& hole, std::vector<Slab>& pieces) {
  const Eigen::Vector2d low = hole.min.cwiseMax(slab.min), high = hole.max.cwiseMin(slab.max);
  if ((high - low).minCoeff() < kTolerance_m) {
    pieces.push_back(slab);
    return;
  }
  const auto add = [&](double x_min, double y_min, double x_max, double y_max) {
    if (x_max - x_min > kTolerance_m && y_max - y_min > kTolerance_m)
      pieces.push_back({{x_min, y_min}, {x_max, y_max}, slab.z_min_m, slab.z_max_m});
  };
  add(slab.min.x(), slab.min.y(), low.x(), slab.max.y());
  add(high.x(), slab.min.y(), slab.max.x(), slab.max.y());
  add(low.x(), slab.min.y(), high.x(), low.y());
  add(low.x(), high.y(), high.x(), slab.max.y());
}

// Cuts the flight's way up out of the slabs above its foot, up to the one that its top is level with.
void cutStairwell(const Stairs& stairs, std::vector<Slab>& slabs) {
  Rectangle well;
  includeStrip(well, stairs.foot, stairs.top, stairs.width_m);
  std::vector<Slab> pieces;
  for (const Slab& slab : slabs) {
    if (slab.z_max_m > stairs.z_min_m + kTolerance_m && slab.z_min_m < stairs.z_max_m - kTolerance_m)
      cutOut(slab, well, pieces);
    else
      pieces.push_back(slab);
  }
  slabs = std::move(pieces);
}

// Top of the highest wall that stands on, or runs through, the floor.
double wallTop(const Scene& scene, double floor_z_m) {
  double top = floor_z_m;
  for (const Wall& wall : scene.walls)
    if (wall.z_min_m <= floor_z_m + 0.5 && wall.z_max_m > floor_z_m) top = std::max(top, wall.z_max_m);
  return top;
}

}  // namespace

std::optional<Opening> openingOf(const Doorway& doorway, const Wall& wall) {
  return openingAt(doorway.xyz, doorway.width_m, doorway.height_m, wall);
}

std::optional<Opening> openingOf(const Window& window, const Wall& wall) {
  auto opening = openingAt(window.xyz, window.width_m, window.height_m, wall);
  if (opening) opening->glazed = window.glazed;
  return opening;
}

std::vector<Opening> openingsOf(const Scene& scene, const Wall& wall) {
  std::vector<Opening> openings;
  for (const Doorway& doorway : scene.doorways)
    if (const auto opening = openingOf(doorway, wall)) openings.push_back(*opening);
  for (const Window& window : scene.windows)
    if (const auto opening = openingOf(window, wall)) openings.push_back(*opening);
  return openings;
}

std::vector<WallPart> wallParts(const Wall& wall, std::vector<Opening> openings) {
  std::vector<double> cuts{0, wall.length()};
  for (const Opening& opening : openings) {
    cuts.push_back(std::clamp(opening.begin_m, 0.0, wall.length()));
    cuts.push_back(std::clamp(opening.end_m, 0.0, wall.length()));
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
  Rectangle outline;
  for (const Wall& wall : scene.walls) includeStrip(outline, wall.a, wall.b, wall.thickness_m);
  std::vector<Slab> slabs;
  if (scene.walls.empty()) return slabs;
  std::vector<double> floors = scene.floors_z_m;
  std::sort(floors.begin(), floors.end());
  for (size_t i = 0; i < floors.size(); ++i) {
    if (i > 0 && floors[i] - floors[i - 1] < kTolerance_m) continue;
    slabs.push_back({outline.min, outline.max, floors[i] - kSlabThickness_m, floors[i]});
    // The next floor's slab is the ceiling if there is no room for another under it.
    const double top = wallTop(scene, floors[i]);
    const bool covered =
        i + 1 < floors.size() && top + kSlabThickness_m > floors[i + 1] - kSlabThickness_m + kTolerance_m;
    if (top > floors[i] && !covered) slabs.push_back({outline.min, outline.max, top, top + kSlabThickness_m});
  }
  for (const Stairs& stairs : scene.stairs) cutStairwell(stairs, slabs);
  return slabs;
}

std::vector<Slab> slabsOf(const Scene& scene) {
  return scene.slabs.empty() ? defaultSlabs(scene) : scene.slabs;
}

TriangleMesh buildMesh(const Scene& scene) {
  TriangleMesh mesh;
  for (const Wall& wall : scene.walls)
    if (!wall.glass)
      for (const WallPart& part : wallParts(wall, openingsOf(scene, wall)))
        addBox(mesh, boxOf(wall, part), kWallReflectivity);
  for (const Box& box : scene.boxes) addBox(mesh, box, kBoxReflectivity);
  for (const Slab& slab : slabsOf(scene)) addSlab(mesh, slab);
  for (const Column& column : scene.columns)
    mesh.addPrism({column.center.x(), column.center.y(), column.z_min_m}, column.radius_m,
                  column.z_max_m - column.z_min_m, kColumnSides, kWallReflectivity);
  for (const Stairs& stairs : scene.stairs) addStairs(mesh, stairs);
  return mesh;
}

TriangleMesh buildGlass(const Scene& scene) {
  TriangleMesh glass;
  for (const Wall& wall : scene.walls) {
    const auto openings = openingsOf(scene, wall);
    if (wall.glass)
      for (const WallPart& part : wallParts(wall, openings))
        addPane(glass, wall, part.begin_m, part.end_m, part.z_min_m, part.z_max_m);
    for (const Opening& opening : openings)
      if (opening.glazed)
        addPane(glass, wall, opening.begin_m, opening.end_m, opening.z_min_m, opening.z_max_m);
  }
  return glass;
}

}  // namespace sgraphs::simulate
