#include "tools/simulate/scene/scene_file.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/base/error.h"
#include "tools/simulate/scene/find_fault.h"
#include "tools/simulate/scene/plan_reader.h"
#include "tools/simulate/scene/read_scene.h"

namespace sgraphs::simulate {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json parseJson(const std::string& text, const std::string& where) {
  try {
    return json::parse(text);
  } catch (const json::exception& error) {
    // The library's text holds "parse error at line 3, column 5: …" behind its own tag; a number out of
    // range comes without a line.
    std::string what = error.what();
    if (const size_t at = what.find("line "); at != std::string::npos) what = what.substr(at);
    std::replace(what.begin(), what.end(), '\n', ' ');
    throw Error(where + ": not JSON: " + what);
  }
}

// Folders of shipped scenes that exist, in the order in which they are searched.
std::vector<fs::path> sceneFolders() {
  std::vector<fs::path> folders;
  if (const char* chosen = std::getenv("SGRAPHS_SCENES")) {
    folders.emplace_back(chosen);
  } else {
    std::error_code ignored;
    const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
    folders.push_back(program.parent_path() / ".." / "share" / "sgraphs" / "scenes");
    folders.emplace_back(SGRAPHS_SOURCE_SCENES_DIR);
  }
  std::erase_if(folders, [](const fs::path& folder) { return !fs::is_directory(folder); });
  return folders;
}

std::string knownScenes() {
  std::vector<std::string> names;
  for (const fs::path& folder : sceneFolders())
    for (const auto& entry : fs::directory_iterator(folder))
      if (fs::exists(entry.path() / "plan.json")) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none is installed (see $SGRAPHS_SCENES)" : text;
}

}  // namespace

std::string findScene(const std::string& scene) {
  const fs::path path(scene);
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  for (const char* mesh : {".ply", ".obj", ".stl", ".dae", ".sdf"})
    if (extension == mesh)
      throw UsageError("scene '" + scene + "': meshes are not in this version: give a plan.json");
  if (fs::is_regular_file(path)) return scene;
  if (fs::is_regular_file(path / "plan.json")) return (path / "plan.json").string();
  if (scene.find('/') == std::string::npos)
    for (const fs::path& folder : sceneFolders())
      if (fs::is_regular_file(folder / scene / "plan.json"))
        return (folder / scene / "plan.json").lexically_normal().string();
  throw UsageError("scene '" + scene +
                   "' is neither a plan.json nor a shipped scene: give a file, or one of " + knownScenes());
}

Scene parseScene(const std::string& text, const std::string& where) {
  const json plan = parseJson(text, where);
  const PlanReader in(plan, where, "");
  in.refuseMisspelt({"scene",    "seed",    "duration_s", "T_body_lidar", "floors", "rooms",      "walls",
                     "doorways", "windows", "boxes",      "columns",      "stairs", "people",     "slabs",
                     "meshes",   "sensor",  "legs",       "faults",       "path",   "start_utime"});
  Scene scene;
  scene.name = in.text("scene", "");
  if (in.has("start_utime")) scene.start.us = static_cast<int64_t>(in.number("start_utime", 0, 0, 4e15));
  if (in.has("T_body_lidar")) scene.T_body_lidar = in.object("T_body_lidar").transform();
  readBuilding(in, scene);
  if (in.has("sensor")) readSensor(in.object("sensor"), scene.sensor);
  if (in.has("legs")) readLegs(in.object("legs"), scene.legs);
  if (in.has("faults")) readFaults(in.object("faults"), scene.faults);
  if (!in.has("path"))
    in.fail("path", "is missing: give {\"waypoints\": [[x, y], …]} (config/scenes/README.md)");
  readPath(in.object("path"), scene);
  if (const auto fault = findFault(scene)) throw Error(where + ": " + *fault);
  return scene;
}

Scene loadScene(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf())) throw Error("cannot read plan '" + path + "': check the path");
  Scene scene = parseScene(text.str(), path);
  if (scene.name.empty()) scene.name = fs::absolute(path).parent_path().filename().string();
  return scene;
}

}  // namespace sgraphs::simulate
