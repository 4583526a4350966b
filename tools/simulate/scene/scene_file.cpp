#include "tools/simulate/scene/scene_file.h"

#include <algorithm>
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

}  // namespace

Scene parseScene(const std::string& text, const std::string& where) {
  const json plan = parseJson(text, where);
  const PlanReader in(plan, where, "");
  in.refuseMisspelt({"scene",    "seed",    "duration_s", "T_body_lidar", "floors", "rooms",       "walls",
                     "doorways", "windows", "boxes",      "columns",      "stairs", "lifts",       "people",
                     "slabs",    "meshes",  "sensor",     "legs",         "faults", "start_utime", "path"});
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
