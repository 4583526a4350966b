#include "tools/eval/evaluate.h"

#include <filesystem>

#include "common/base/error.h"

namespace sgraphs {
namespace {

constexpr Duration kMaxGap{200'000};
constexpr double kRelativePath_m = 1.0;
constexpr Duration kRelativeTime{1'000'000};

TrajectoryResult judgeTrajectory(const std::string& out_dir, const std::string& file, const Truth& truth) {
  TrajectoryResult result;
  result.file = file;
  const std::string path = out_dir + "/" + file;
  if (!std::filesystem::exists(path)) {
    result.missing = "OUT has no such file";
    return result;
  }
  try {
    result.poses = readTum(path);
    result.absolute = absoluteError(truth.poses, result.poses);
  } catch (const Error& error) {
    result.missing = error.what();
    return result;
  }
  result.nearest_stamp_m = absoluteErrorNearestStamp(truth.poses, result.poses);
  result.per_metre = relativeErrorPerPath(truth.poses, result.poses, kRelativePath_m);
  result.per_second = relativeErrorPerTime(truth.poses, result.poses, kRelativeTime);
  result.time_coverage = timeCoverage(truth.poses, result.poses, kMaxGap);
  return result;
}

MapResult judgeMap(const std::string& out_dir, const Truth& truth, const SE3& T_truth_map) {
  MapResult result;
  const std::string path = out_dir + "/map.ply";
  if (!std::filesystem::exists(path)) {
    result.missing = "OUT has no map.ply";
    return result;
  }
  for (const auto& p : readPlyPoints(path).points)
    result.points_truth.push_back(T_truth_map * p.cast<double>());
  if (!truth.mesh) result.missing = "the truth has no mesh.ply";
  if (result.points_truth.empty()) result.missing = "map.ply holds no point";
  if (!result.missing.empty()) return result;
  std::vector<Eigen::Vector3d> walked;
  for (const auto& pose : truth.poses) walked.push_back(pose.pose.translation);
  result.error = mapError(*truth.mesh, result.points_truth, walked);
  return result;
}

std::string whyWallsCannotBeJudged(bool has_graph, const Truth& truth) {
  if (!has_graph) return "OUT has no graph.json";
  if (!truth.plan || truth.plan->walls.empty()) return "the truth has no plan.json with walls";
  if (!truth.mesh) return "the truth has no mesh.ply";
  return {};
}

// Why a layer of the graph cannot be judged: the truth does not hold it, or this run did not make it.
std::string whyMissing(const std::string& layer, bool has_graph, bool in_truth, bool in_graph) {
  if (!in_truth) return "the truth has no plan.json with " + layer;
  if (!has_graph) return "missing in this run: OUT has no graph.json";
  if (!in_graph) return "missing in this run: graph.json holds no " + layer;
  return {};
}

void judgeLayers(const EstimatedGraph& graph, bool has_graph, const Truth& truth, const SE3& T_truth_map,
                 Evaluation& evaluation) {
  const Plan plan = truth.plan.value_or(Plan{});
  evaluation.rooms = judgeRooms(plan, truth.poses, graph, T_truth_map);
  evaluation.floors = judgeFloors(plan, truth.poses, graph.floors, T_truth_map);
  evaluation.doorways = judgeDoorways(plan, truth.poses, graph, T_truth_map);
  evaluation.rooms.missing = whyMissing("rooms", has_graph, !plan.rooms.empty(), !graph.rooms.empty());
  evaluation.floors.missing =
      whyMissing("floors", has_graph, !plan.floors_z_m.empty(), !graph.floors.empty());
  evaluation.doorways.missing =
      whyMissing("doorways", has_graph, !plan.doorways.empty(), !graph.doorways.empty());
  if (evaluation.floors.numAsked() > 1)
    evaluation.by_storey = errorByStorey(plan, truth.poses, evaluation.trajectories.front().absolute);
}

void judgeGraph(const std::string& graph_json_path, const Truth& truth, const SE3& T_truth_map,
                Evaluation& evaluation) {
  const bool has_graph = std::filesystem::exists(graph_json_path);
  EstimatedGraph graph;
  if (has_graph) graph = readEstimatedGraph(graph_json_path);
  evaluation.walls.missing = whyWallsCannotBeJudged(has_graph, truth);
  if (evaluation.walls.missing.empty())
    evaluation.walls = judgeWalls(*truth.plan, MeshQuery(*truth.mesh), truth.poses, graph.walls, T_truth_map);
  evaluation.estimates = calibrationOfEstimates(graph, truth.poses, evaluation.walls);
  judgeLayers(graph, has_graph, truth, T_truth_map, evaluation);
}

}  // namespace

Evaluation evaluate(const std::string& out_dir, const Truth& truth) {
  if (!std::filesystem::exists(out_dir + "/trajectory.tum"))
    throw Error("'" + out_dir + "' holds no trajectory.tum: make it with 'sgraphs replay LOG -o " + out_dir +
                "'");
  Evaluation evaluation;
  for (const char* file : {"trajectory.tum", "keyframes.tum", "odometry.tum"})
    evaluation.trajectories.push_back(judgeTrajectory(out_dir, file, truth));
  // Without the alignment nothing else can be judged.
  const TrajectoryResult& first = evaluation.trajectories.front();
  if (!first.missing.empty()) throw Error("cannot judge '" + out_dir + "/trajectory.tum': " + first.missing);
  evaluation.map = judgeMap(out_dir, truth, first.absolute.T_truth_map);
  if (std::filesystem::exists(out_dir + "/graph.json")) {
    const std::vector<MeasuredLink> links = readMeasuredLinks(out_dir + "/graph.json");
    evaluation.calibration = calibrationOf(links, truth.poses);
    evaluation.loops = judgeLoops(links, truth.poses);
  }
  if (evaluation.calibration.empty())
    evaluation.calibration_missing = "graph.json has no links with a covariance in the truth's time";
  judgeGraph(out_dir + "/graph.json", truth, first.absolute.T_truth_map, evaluation);
  return evaluation;
}

}  // namespace sgraphs
