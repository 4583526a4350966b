#include "tools/eval/evaluate.h"

#include <algorithm>
#include <filesystem>

#include "common/base/error.h"
#include "tools/eval/ride_heights.h"

namespace sgraphs {
namespace {

constexpr Duration kMaxGap{200'000};
constexpr double kRelativePath_m = 1.0;
constexpr Duration kRelativeTime{1'000'000};

TrajectoryResult judgeTrajectory(const std::string& out_dir, const std::string& file, const Truth& truth,
                                 const std::optional<RideHeights>& rides) {
  TrajectoryResult result;
  result.file = file;
  const std::string path = out_dir + "/" + file;
  if (!std::filesystem::exists(path)) {
    result.missing = "OUT has no such file";
    return result;
  }
  try {
    result.poses = readTum(path);
    result.time_coverage = timeCoverage(truth.poses, result.poses, kMaxGap);
    if (rides) {
      RideHeights(result.poses, truth.poses).correct(result.poses);
      std::erase_if(result.poses, [&](const StampedPose& p) { return rides->riding(p.time); });
    }
    result.absolute = absoluteError(truth.poses, result.poses);
  } catch (const Error& error) {
    result.missing = error.what();
    return result;
  }
  result.nearest_stamp_m = absoluteErrorNearestStamp(truth.poses, result.poses);
  result.per_metre = relativeErrorPerPath(truth.poses, result.poses, kRelativePath_m);
  result.per_second = relativeErrorPerTime(truth.poses, result.poses, kRelativeTime);
  return result;
}

MapResult judgeMap(const std::string& out_dir, const Truth& truth, const SE3& T_truth_map,
                   const std::optional<RideHeights>& rides) {
  MapResult result;
  const std::string path = out_dir + "/map.ply";
  if (!std::filesystem::exists(path)) {
    result.missing = "OUT has no map.ply";
    return result;
  }
  for (const auto& p : readPlyPoints(path).points) {
    const double rise_m = rides ? rides->shiftAt(static_cast<double>(p.z())) : 0.0;
    result.points_truth.push_back(T_truth_map * (p.cast<double>() + Eigen::Vector3d(0, 0, rise_m)));
  }
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

void judgeGraph(const EstimatedGraph& graph, bool has_graph, const Truth& truth, const SE3& T_truth_map,
                Evaluation& evaluation) {
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
  const std::string graph_path = out_dir + "/graph.json";
  const bool has_graph = std::filesystem::exists(graph_path);
  EstimatedGraph graph = has_graph ? readEstimatedGraph(graph_path) : EstimatedGraph{};
  const bool by_lift = std::any_of(graph.floors.begin(), graph.floors.end(),
                                   [](const EstimatedFloor& floor) { return !floor.height_known; });
  std::optional<RideHeights> rides;
  if (by_lift) rides.emplace(readTum(out_dir + "/trajectory.tum"), truth.poses);
  for (const char* file : {"trajectory.tum", "keyframes.tum", "odometry.tum"})
    evaluation.trajectories.push_back(judgeTrajectory(out_dir, file, truth, rides));
  // Without the alignment nothing else can be judged.
  const TrajectoryResult& first = evaluation.trajectories.front();
  if (!first.missing.empty()) throw Error("cannot judge '" + out_dir + "/trajectory.tum': " + first.missing);
  evaluation.map = judgeMap(out_dir, truth, first.absolute.T_truth_map, rides);
  if (rides) rides->correct(graph);
  if (has_graph) {
    std::vector<MeasuredLink> links = readMeasuredLinks(graph_path);
    if (rides)
      std::erase_if(links, [&](const MeasuredLink& link) {
        return rides->riding(link.from) || rides->riding(link.to);
      });
    evaluation.calibration = calibrationOf(links, truth.poses);
    evaluation.loops = judgeLoops(links, truth.poses);
  }
  if (evaluation.calibration.empty())
    evaluation.calibration_missing = "graph.json has no links with a covariance in the truth's time";
  judgeGraph(graph, has_graph, truth, first.absolute.T_truth_map, evaluation);
  if (rides) evaluation.floors.by_lift = rides->levels() - 1;
  return evaluation;
}

}  // namespace sgraphs
