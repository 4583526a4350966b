#include "tools/eval/eval_report.h"

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace sgraphs {
namespace {

using Json = nlohmann::ordered_json;

__attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

std::string relativeCell(const std::optional<RelativeError>& error) {
  if (!error) return format("%17s", "-");
  return format("%7.4f m %5.2f deg", error->translation_m.rmse, error->rotation_rad.rmse * 180 / M_PI);
}

std::string trajectoryRow(const TrajectoryResult& t) {
  if (!t.missing.empty()) return format("%-14s  not judged: ", t.file.c_str()) + t.missing + "\n";
  const auto& ate = t.absolute.translation_m;
  const std::string evo = t.nearest_stamp_m ? format("%8.4f", t.nearest_stamp_m->rmse) : format("%8s", "-");
  return format("%-14s %6zu %8.4f %8.4f %8.4f %s  ", t.file.c_str(), t.poses.size(), ate.rmse, ate.median,
                ate.max, evo.c_str()) +
         relativeCell(t.per_metre) + "  " + relativeCell(t.per_second) +
         format(" %8.2f %%\n", 100 * t.time_coverage);
}

std::string mapLines(const MapResult& map) {
  if (!map.missing.empty()) return "map       not judged: " + map.missing + "\n";
  const MapError& e = map.error;
  return format(
             "map       RMSE %.4f m, median %.4f m, max %.3f m, %zu points; completeness %.4f of %.0f m2 "
             "seen: ",
             e.distance_m.rmse, e.distance_m.median, e.distance_m.max, e.distance_m.count, e.completeness,
             e.visible_area_m2) +
         (map.counts() ? "counts\n" : format("does NOT count (needs %.2f)\n", MapResult::kMinCompleteness));
}

std::string calibrationLines(const Evaluation& evaluation) {
  if (evaluation.calibration.empty()) return "NEES      not judged: " + evaluation.calibration_missing + "\n";
  std::string lines;
  for (const auto& [kind, c] : evaluation.calibration)
    lines += format(
        "NEES      %-10s translation %6.2f (%3.0f %% inside 95 %%), rotation %6.2f (%3.0f %%), %zu links\n",
        kind.c_str(), c.nees_translation, 100 * c.inside_translation, c.nees_rotation,
        100 * c.inside_rotation, c.count);
  return lines;
}

std::string layerLine(const LayerResult& layer) {
  const std::string asked = layer.asked ? format("; the truth asks for %zu", *layer.asked) : std::string();
  const std::string found = layer.in_graph
                                ? format("%zu in the graph, not judged in this version", layer.in_graph)
                                : std::string("missing in this version's graph");
  return format("%-9s ", layer.layer.c_str()) + found + asked + "\n";
}

Json statisticsJson(const ErrorStatistics& s) {
  return {{"count", s.count}, {"rmse", s.rmse}, {"median", s.median}, {"max", s.max}};
}

Json relativeJson(const std::optional<RelativeError>& error) {
  if (!error) return nullptr;
  return {{"translation_m", statisticsJson(error->translation_m)},
          {"rotation_rad", statisticsJson(error->rotation_rad)}};
}

Json trajectoryJson(const TrajectoryResult& t) {
  if (!t.missing.empty()) return {{"missing", t.missing}};
  const SE3& T = t.absolute.T_truth_map;
  return {{"poses", t.poses.size()},
          {"ate_m", statisticsJson(t.absolute.translation_m)},
          {"ate_nearest_stamp_m", t.nearest_stamp_m ? statisticsJson(*t.nearest_stamp_m) : Json(nullptr)},
          {"rpe_per_metre", relativeJson(t.per_metre)},
          {"rpe_per_second", relativeJson(t.per_second)},
          {"time_coverage", t.time_coverage},
          {"T_truth_estimate",
           {{"xyz", {T.translation.x(), T.translation.y(), T.translation.z()}},
            {"qxyzw", {T.rotation.x(), T.rotation.y(), T.rotation.z(), T.rotation.w()}}}}};
}

Json mapJson(const MapResult& map) {
  if (!map.missing.empty()) return {{"missing", map.missing}};
  return {{"distance_m", statisticsJson(map.error.distance_m)},
          {"completeness", map.error.completeness},
          {"visible_area_m2", map.error.visible_area_m2},
          {"counts", map.counts()}};
}

}  // namespace

std::string evaluationTable(const Evaluation& evaluation) {
  std::string table = format("%-14s %6s %8s %8s %8s %8s  %17s  %17s %10s\n", "trajectory [m]", "poses", "ATE",
                             "median", "max", "evo", "RPE per 1 m", "RPE per 1 s", "coverage");
  for (const auto& t : evaluation.trajectories) table += trajectoryRow(t);
  table += mapLines(evaluation.map) + calibrationLines(evaluation);
  for (const auto& layer : evaluation.layers) table += layerLine(layer);
  return table;
}

std::string evaluationJson(const Evaluation& evaluation) {
  Json json;
  json["schema"] = "sgraphs-eval/1";
  for (const auto& t : evaluation.trajectories) json["trajectories"][t.file] = trajectoryJson(t);
  json["map"] = mapJson(evaluation.map);
  json["nees"] = Json::object();
  for (const auto& [kind, c] : evaluation.calibration)
    json["nees"][kind] = {{"count", c.count},
                          {"translation", c.nees_translation},
                          {"rotation", c.nees_rotation},
                          {"inside_95_translation", c.inside_translation},
                          {"inside_95_rotation", c.inside_rotation}};
  for (const auto& layer : evaluation.layers)
    json["layers"][layer.layer] = {{"in_graph", layer.in_graph},
                                   {"asked", layer.asked ? Json(*layer.asked) : Json(nullptr)}};
  return json.dump(2) + "\n";
}

}  // namespace sgraphs
