#include "tools/simulate/scene/scene_source.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/base/error.h"
#include "common/base/sha256.h"
#include "tools/simulate/building/mesh_import.h"
#include "tools/simulate/building/mesh_surface.h"
#include "tools/simulate/building/mesh_walk.h"
#include "tools/simulate/building/ray_caster.h"
#include "tools/simulate/scene/find_scene.h"
#include "tools/simulate/scene/plan_override.h"
#include "tools/simulate/scene/scene_file.h"

namespace sgraphs::simulate {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kGroundMargin_m = 2;  // of the ground laid under a mesh without floor
constexpr double kGroundThickness_m = 0.1;

std::string readText(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf())) throw Error("cannot read '" + path + "': check the path");
  return text.str();
}

json readJson(const std::string& path) {
  const std::string text = readText(path);
  try {
    return json::parse(text);
  } catch (const json::exception& error) {
    // Behind the library's own tag stands "parse error at line 3, column 5: …".
    std::string what = error.what();
    if (const size_t at = what.find("line "); at != std::string::npos) what = what.substr(at);
    std::replace(what.begin(), what.end(), '\n', ' ');
    throw Error(path + ": not JSON: " + what);
  }
}

// A walk is a plan's `path`, or nothing but its waypoints.
void setWalk(json& plan, const std::string& file) {
  json walk = readJson(file);
  if (walk.is_object())
    plan["path"] = std::move(walk);
  else if (walk.is_array())
    plan["path"]["waypoints"] = std::move(walk);
  else
    throw Error(file + ": must hold a list of waypoints [[x, y], …] or a plan's path {\"waypoints\": …}");
}

// The meshes of a scene, whose paths are relative to `folder`.
TriangleMesh importAll(const Scene& scene, const fs::path& folder, std::vector<std::string>& warnings) {
  TriangleMesh all;
  for (MeshFile file : scene.meshes) {
    file.path = (folder / file.path).lexically_normal().string();
    ImportedMesh imported = importMesh(file);
    append(all, imported.mesh);
    warnings.insert(warnings.end(), imported.warnings.begin(), imported.warnings.end());
  }
  return all;
}

std::string metres(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.2f", value);
  return buffer;
}

// Gives a plan that is a mesh its floor.
void setFloor(json& plan, const Scene& scene, const TriangleMesh& mesh, std::vector<std::string>& warnings) {
  const Eigen::AlignedBox3d bounds = boundsOf(mesh);
  const Eigen::Vector2d start = scene.path.waypoints.front().xy;
  const auto surfaces = walkingSurfaces(RayCaster(mesh), start, bounds.min().z(), bounds.max().z());
  if (!surfaces.empty()) {
    plan["floors"] = {surfaces.front()};
    if (surfaces.size() == 1) return;
    warnings.push_back(std::to_string(surfaces.size()) +
                       " walking surfaces lie under the first waypoint; the lowest, at " +
                       metres(surfaces.front()) + " m, is the floor: --set floors=[" + metres(surfaces[1]) +
                       "] chooses the next");
    return;
  }
  const double z = bounds.min().z();
  const Eigen::Vector3d low = bounds.min().array() - kGroundMargin_m;
  const Eigen::Vector3d high = bounds.max().array() + kGroundMargin_m;
  plan["floors"] = {z};
  if (!plan.contains("slabs"))
    plan["slabs"] = {
        {{"min", {low.x(), low.y()}}, {"max", {high.x(), high.y()}}, {"z", {z - kGroundThickness_m, z}}}};
  warnings.push_back("the mesh has no floor under the first waypoint: a ground is laid under it at " +
                     metres(z) + " m; --set floors=[z] and --set slabs=[] leave it out");
}

void checkWalk(const SceneSource& source, const std::string& where) {
  if (source.imported.triangles.empty()) return;
  const Scene& scene = source.scene;
  const RayCaster mesh(source.imported);
  const double floor_z = scene.floors_z_m[static_cast<size_t>(scene.path_floor)];
  const double top = scene.path.body_height_m + std::max(0.0, scene.T_body_lidar.translation.z());
  if (const auto fault = meshWalkFault(mesh, scene.path, floor_z, top)) throw Error(where + ": " + *fault);
}

std::string digestOf(const std::string& text, const TriangleMesh& imported) {
  Sha256 digest;
  digest.add(text);
  for (const auto& v : imported.vertices) digest.add(v);
  for (const auto& t : imported.triangles)
    for (const uint32_t i : t) digest.add(static_cast<int64_t>(i));
  return digest.hex();
}

// That of the file, or of the folder of a model.sdf.
std::string nameOfMesh(const fs::path& path) {
  return (path.stem() == "model" ? fs::absolute(path).parent_path().filename() : path.stem()).string();
}

SceneSource openMesh(const std::string& path, const SceneRequest& request) {
  if (request.waypoints.empty())
    throw UsageError("scene '" + path +
                     "' is a mesh: give --waypoints FILE, which holds [[x, y], …] or a plan's path object");
  json plan{{"scene", nameOfMesh(path)}, {"meshes", {{{"path", fs::absolute(path).string()}}}}};
  setWalk(plan, request.waypoints);
  for (const std::string& assignment : request.overrides) overridePlan(plan, assignment);
  SceneSource source;
  source.scene = parseScene(plan.dump(), request.waypoints);
  source.imported = importAll(source.scene, {}, source.warnings);
  if (!plan.contains("floors")) {
    setFloor(plan, source.scene, source.imported, source.warnings);
    source.scene = parseScene(plan.dump(), request.waypoints);
  }
  checkWalk(source, request.waypoints);
  plan.erase("meshes");  // their surfaces count, not where they lie on this machine
  source.digest = digestOf(plan.dump(), source.imported);
  return source;
}

SceneSource openPlan(const std::string& path, const SceneRequest& request) {
  SceneSource source;
  if (request.waypoints.empty() && request.overrides.empty()) {
    source.scene = loadScene(path);
    source.digest = sha256OfFile(path);
  } else {
    json plan = readJson(path);
    if (!plan.is_object()) throw Error(path + ": the plan must be an object {…}");
    if (!request.waypoints.empty()) setWalk(plan, request.waypoints);
    for (const std::string& assignment : request.overrides) overridePlan(plan, assignment);
    source.scene = parseScene(plan.dump(), path);
    if (source.scene.name.empty()) source.scene.name = fs::absolute(path).parent_path().filename().string();
    source.digest = digestOf(plan.dump(), {});
  }
  if (source.scene.meshes.empty()) return source;
  source.imported = importAll(source.scene, fs::path(path).parent_path(), source.warnings);
  checkWalk(source, path);
  source.digest = digestOf(source.digest, source.imported);
  return source;
}

}  // namespace

SceneSource openScene(const SceneRequest& request) {
  const std::string path = findScene(request.scene);
  return isMeshPath(path) ? openMesh(path, request) : openPlan(path, request);
}

}  // namespace sgraphs::simulate
