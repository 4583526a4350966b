#include "tools/eval/eval_report.h"

#include <cmath>

#include "tools/eval/layer_report.h"

namespace sgraphs {
namespace {

using report::format;
using report::Json;
using report::statisticsJson;

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

std::string loopLine(const LoopResult& loops) {
  return format(
      "loops     %zu accepted, %zu of them false; off by %.4f m in the median, %.4f at most; %zu of %zu "
      "returns missed\n",
      loops.accepted, loops.wrong, loops.median_m, loops.max_m, loops.missed, loops.revisits);
}

std::string faceCounts(const WallResult::Counts& c) {
  return format("%zu found, %zu missed, %zu doubled", c.found, c.missed, c.doubled);
}

std::string wallLines(const WallResult& walls) {
  if (!walls.missing.empty()) return "walls     not judged: " + walls.missing + "\n";
  const auto asked = walls.counts(true), others = walls.counts(false);
  std::string lines =
      format("walls     %zu faces seen for %.0f s or more: ", asked.faces, WallResult::kAskedAfter_s) +
      faceCounts(asked) + format("; %zu others: ", others.faces) + faceCounts(others) + "\n";
  lines +=
      format("walls     %zu in the graph, %zu of them false", walls.walls.size(), walls.false_walls.size());
  if (!walls.matches.empty())
    lines += format("; angle median %.2f deg, max %.2f deg, offset median %.4f m, max %.4f m",
                    walls.angle_rad.median * 180 / M_PI, walls.angle_rad.max * 180 / M_PI,
                    walls.offset_m.median, walls.offset_m.max);
  return lines + "\n";
}

std::string neesCell(const char* what, const NeesStatistics& s) {
  return format("%s mean %.2f, median %.2f (%d is right)", what, s.mean, s.median, s.dof);
}

std::string estimateLines(const EstimateCalibration& e) {
  std::string lines = "NEES of optimised poses   ";
  lines += e.pose.count
               ? neesCell("translation", e.pose_translation) + "; " + neesCell("rotation", e.pose_rotation) +
                     "; " + neesCell("both", e.pose) + format("; %zu keyframes\n", e.pose.count)
               : std::string("not judged: graph.json has no covariance of a keyframe\n");
  lines += "NEES of optimised planes  ";
  lines += e.plane_tilt.count ? neesCell("tilt", e.plane_tilt) + "; " + neesCell("offset", e.plane_offset) +
                                    format("; %zu walls\n", e.plane_tilt.count)
                              : std::string("not judged: no wall lies on a true face\n");
  return lines;
}

Json neesJson(const NeesStatistics& s) {
  return {{"dof", s.dof}, {"count", s.count}, {"mean", s.mean}, {"median", s.median}};
}

Json estimatesJson(const EstimateCalibration& e) {
  return {{"pose", neesJson(e.pose)},
          {"pose_translation", neesJson(e.pose_translation)},
          {"pose_rotation", neesJson(e.pose_rotation)},
          {"plane_tilt", neesJson(e.plane_tilt)},
          {"plane_offset", neesJson(e.plane_offset)}};
}

Json countsJson(const WallResult::Counts& c) {
  return {{"faces", c.faces}, {"found", c.found}, {"missed", c.missed}, {"doubled", c.doubled}};
}

Json faceJson(const WallResult& walls, size_t f) {
  const TrueFace& face = walls.faces[f];
  Json estimates = Json::array();
  for (const WallMatch& match : walls.matches)
    if (match.face == f)
      estimates.push_back({{"id", walls.walls[match.wall].id},
                           {"angle_rad", match.angle_rad},
                           {"offset_m", match.offset_m},
                           {"samples", match.claimed.size()}});
  return {{"wall", face.wall},
          {"begin", {face.begin.x(), face.begin.y()}},
          {"end", {face.end.x(), face.end.y()}},
          {"seen_s", face.seen_s},
          {"asked", walls.asked(f)},
          {"found", static_cast<bool>(walls.found[f])},
          {"doubled", static_cast<bool>(walls.doubled[f])},
          {"estimates", std::move(estimates)}};
}

Json wallsJson(const WallResult& walls) {
  if (!walls.missing.empty()) return {{"missing", walls.missing}};
  Json false_walls = Json::array(), faces = Json::array();
  for (const size_t w : walls.false_walls) false_walls.push_back(walls.walls[w].id);
  for (size_t f = 0; f < walls.faces.size(); ++f) faces.push_back(faceJson(walls, f));
  return {{"in_graph", walls.walls.size()},
          {"asked", countsJson(walls.counts(true))},
          {"not_asked", countsJson(walls.counts(false))},
          {"false", std::move(false_walls)},
          {"angle_rad", statisticsJson(walls.angle_rad)},
          {"offset_m", statisticsJson(walls.offset_m)},
          {"faces", std::move(faces)}};
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
  table += mapLines(evaluation.map) + calibrationLines(evaluation) + loopLine(evaluation.loops) +
           estimateLines(evaluation.estimates) + wallLines(evaluation.walls) +
           report::roomLines(evaluation.rooms) + report::floorLines(evaluation.floors, evaluation.by_storey) +
           report::doorwayLines(evaluation.doorways);
  return table;
}

std::string evaluationJson(const Evaluation& evaluation) {
  Json json;
  json["schema"] = "sgraphs-eval/2";
  for (const auto& t : evaluation.trajectories) json["trajectories"][t.file] = trajectoryJson(t);
  json["map"] = mapJson(evaluation.map);
  json["nees"] = Json::object();
  for (const auto& [kind, c] : evaluation.calibration)
    json["nees"][kind] = {{"count", c.count},
                          {"translation", c.nees_translation},
                          {"rotation", c.nees_rotation},
                          {"inside_95_translation", c.inside_translation},
                          {"inside_95_rotation", c.inside_rotation}};
  const LoopResult& loops = evaluation.loops;
  json["loops"] = {{"accepted", loops.accepted}, {"false", loops.wrong},      {"median_m", loops.median_m},
                   {"max_m", loops.max_m},       {"returns", loops.revisits}, {"missed", loops.missed}};
  json["nees_of_estimates"] = estimatesJson(evaluation.estimates);
  json["walls"] = wallsJson(evaluation.walls);
  json["rooms"] = report::roomsJson(evaluation.rooms);
  json["floors"] = report::floorsJson(evaluation.floors, evaluation.by_storey);
  json["doorways"] = report::doorwaysJson(evaluation.doorways);
  return json.dump(2) + "\n";
}

}  // namespace sgraphs
