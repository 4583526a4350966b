#include "tools/bench/accuracy/run_result.h"

#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "common/io/text_file.h"

namespace sgraphs::bench {
namespace {

using Json = nlohmann::ordered_json;

// A figure and where it stands; lists count by their length.
struct Source {
  const char* figure;
  const char* pointer;
};
constexpr Source kOfEval[] = {
    {"ate_m", "/trajectories/trajectory.tum/ate_m/rmse"},
    {"odometry_ate_m", "/trajectories/odometry.tum/ate_m/rmse"},
    {"time_coverage", "/trajectories/trajectory.tum/time_coverage"},
    {"map_rmse_m", "/map/distance_m/rmse"},
    {"map_completeness", "/map/completeness"},
    {"walls_asked", "/walls/asked/faces"},
    {"walls_found", "/walls/asked/found"},
    {"walls_missed", "/walls/asked/missed"},
    {"walls_doubled", "/walls/asked/doubled"},
    {"walls_false", "/walls/false"},
    {"rooms_asked", "/rooms/asked"},
    {"room_precision", "/rooms/precision"},
    {"room_recall", "/rooms/recall"},
    {"room_iou", "/rooms/mean_iou"},
    {"room_detection_s", "/rooms/detection_s/median"},
    {"doorway_recall", "/doorways/of_asked_rooms/recall"},
    {"doorways_false", "/doorways/false"},
    {"odometry_nees_translation", "/nees/odometry/translation"},
    {"odometry_nees_rotation", "/nees/odometry/rotation"},
    {"pose_nees_translation", "/nees_of_estimates/pose_translation/mean"},
    {"pose_nees_rotation", "/nees_of_estimates/pose_rotation/mean"},
};
constexpr Source kOfSummary[] = {
    {"duration_s", "/duration_s"},
    {"realtime_factor", "/realtime_factor"},
    {"peak_rss_mib", "/peak_rss_mib"},
    {"odometry_p50_ms", "/stages/odometry/p50_ms"},
    {"baseline_p50_ms", "/stages/scan/p50_ms"},
    {"reproducible", "/reproducible"},
    {"failed_matches", "/failed_matches"},
    {"loops", "/loops"},
};

Json parse(const std::string& text, const std::string& where) {
  try {
    return Json::parse(text);
  } catch (const Json::exception& error) {
    throw Error("cannot read '" + where + "': " + error.what());
  }
}

template <size_t N>
void collect(const Source (&sources)[N], const std::string& path, std::map<std::string, double>& figures) {
  const Json json = parse(readFile(path), path);
  for (const Source& source : sources) {
    const Json::json_pointer pointer(source.pointer);
    if (!json.contains(pointer)) continue;
    const Json& value = json.at(pointer);
    if (value.is_number()) figures[source.figure] = value.get<double>();
    if (value.is_boolean()) figures[source.figure] = value.get<bool>() ? 1 : 0;
    if (value.is_array()) figures[source.figure] = static_cast<double>(value.size());
  }
}

// Means over nothing are no figures: a baseline's OUT has no graph.
void dropEmptyNees(const std::string& eval_path, std::map<std::string, double>& figures) {
  const Json json = parse(readFile(eval_path), eval_path);
  const Json::json_pointer count("/nees_of_estimates/pose_translation/count");
  if (json.contains(count) && json.at(count) != 0) return;
  figures.erase("pose_nees_translation");
  figures.erase("pose_nees_rotation");
}

}  // namespace

std::optional<double> RunResult::figure(const std::string& name) const {
  const auto found = figures.find(name);
  return found == figures.end() ? std::nullopt : std::optional(found->second);
}

std::map<std::string, double> figuresOf(const std::string& out_dir) {
  std::map<std::string, double> figures;
  collect(kOfEval, out_dir + "/eval.json", figures);
  dropEmptyNees(out_dir + "/eval.json", figures);
  collect(kOfSummary, out_dir + "/summary.json", figures);
  return figures;
}

std::string toJson(const RunResult& result) {
  Json json;
  json["schema"] = "sgraphs-bench-accuracy/1";
  json["scene"] = result.key.scene;
  json["scene_digest"] = result.key.scene_digest;
  json["seed"] = result.key.seed;
  json["run"] = result.key.run;
  json["settings"] = result.key.settings;
  json["program"] = result.key.program;
  json["failed"] = result.failed;
  json["figures"] = Json::object();
  for (const auto& [name, value] : result.figures) json["figures"][name] = value;
  return json.dump(2) + "\n";
}

RunResult resultFromJson(const std::string& text, const std::string& where) {
  const Json json = parse(text, where);
  try {
    if (json.at("schema") != "sgraphs-bench-accuracy/1") throw Error("'" + where + "' has another schema");
    RunResult result;
    result.key = {json.at("scene"), json.at("scene_digest"), json.at("seed"),
                  json.at("run"),   json.at("settings"),     json.at("program")};
    result.failed = json.at("failed");
    for (const auto& [name, value] : json.at("figures").items()) result.figures[name] = value.get<double>();
    return result;
  } catch (const Json::exception& error) {
    throw Error("'" + where + "' is no result of `sgraphs bench accuracy`: " + error.what());
  }
}

}  // namespace sgraphs::bench
