#include "tools/simulate/building/mesh_import.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "common/base/error.h"
#include "tools/simulate/building/mesh_assimp.h"
#include "tools/simulate/building/mesh_sdf.h"
#include "tools/simulate/building/mesh_surface.h"
#include "tools/simulate/scene/find_scene.h"

namespace sgraphs::simulate {
namespace {

// No building, and no piece of furniture, is smaller or larger.
constexpr double kSmallest_m = 0.1;
constexpr double kLargest_m = 2000;
constexpr double kFarthest_m = 10000;  // rays are cast in single precision

std::string endingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return ending;
}

template <typename... Values>
std::string format(const char* pattern, Values... values) {
  char line[256];
  std::snprintf(line, sizeof line, pattern, values...);
  return line;
}

// Throws Error about a mesh that cannot be a building.
void check(const std::string& path, const TriangleMesh& mesh) {
  if (mesh.triangles.empty())
    throw Error("mesh '" + path + "' holds no triangle: export surfaces, not points or lines");
  if (!isFinite(mesh)) throw Error("mesh '" + path + "' has a vertex that is not finite: export it anew");
  const Eigen::AlignedBox3d bounds = boundsOf(mesh);
  const double size = bounds.sizes().maxCoeff();
  if (size > kLargest_m || size < kSmallest_m)
    throw Error("mesh '" + path + "' is " + format("%.3g", size) +
                " m long: is it drawn in another unit? Give its \"scale\" (--set meshes.0.scale=" +
                (size > kLargest_m ? "0.001 for millimetres)" : "1000 for kilometres)"));
  const double distance = bounds.center().norm();
  if (distance > kFarthest_m)
    throw Error("mesh '" + path + "' lies " + format("%.3g", distance) +
                " m from the origin: bring it there with \"T_building_mesh\"");
}

}  // namespace

ImportedMesh importMesh(const MeshFile& file) {
  if (!isMeshPath(file.path))
    throw Error("mesh '" + file.path + "' is of an unknown kind: known are .ply, .obj, .stl, .dae and .sdf");
  SdfSurfaces read;
  if (endingOf(file.path) == ".sdf")
    read = readSdf(file.path);
  else
    read.mesh = readMeshFile(file.path);
  ImportedMesh out{{}, std::move(read.warnings)};
  append(out.mesh, read.mesh, file.T_building_mesh, Eigen::Vector3d::Constant(file.scale));
  check(file.path, out.mesh);
  if (const int64_t dropped = dropDegenerate(out.mesh); dropped > 0)
    out.warnings.push_back(file.path + ": " + std::to_string(dropped) +
                           " triangles without area are left out");
  if (out.mesh.triangles.empty())
    throw Error("mesh '" + file.path + "' holds no triangle that has an area: export it anew");
  if (const OpenEdges open = findOpenEdges(out.mesh); open.count > 0)
    out.warnings.push_back(file.path + ": the mesh has holes: " + std::to_string(open.count) +
                           " edges belong to one triangle only, the first near " +
                           format("(%.2f, %.2f, %.2f)", open.first.x(), open.first.y(), open.first.z()) +
                           "; rays pass there");
  return out;
}

}  // namespace sgraphs::simulate
