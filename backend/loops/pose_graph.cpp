#include "backend/loops/pose_graph.h"

#include <optional>
#include <set>
#include <utility>

#include "backend/factors/relative_pose_cost.h"
#include "backend/factors/up_cost.h"
#include "backend/solver/incremental_solver.h"

namespace sgraphs {
namespace {

constexpr int kMaxIterations = 50;
// A measurement is bent away from the present shape only if both agree to this many sigma squared; else it is
// the shape that is wrong there, and the measurement that is kept.
constexpr double kPresentShapeChi2 = 27.9;

std::map<KeyframeId, SE3> solved(const SituationalGraph& graph, bool keep_shape) {
  SolverOptions options;
  options.max_iterations = kMaxIterations;
  IncrementalSolver solver(options);
  std::map<KeyframeId, IncrementalSolver::StateId> states;
  for (const auto& [id, node] : graph.keyframes) {
    states[id] = solver.addPose(node.T_map_body);
    if (states.size() == 1) solver.hold(states[id]);
  }
  for (const RelativePoseFactor& f : graph.relative_poses) {
    const RelativePose& z = f.measurement;
    SE3 T = z.T_from_to;
    if (keep_shape && z.kind != RelativePoseKind::kLoop) {
      const SE3 now = graph.keyframes.at(z.from).T_map_body.inverse() * graph.keyframes.at(z.to).T_map_body;
      const Vector6d off = se3Log(T.inverse() * now);
      if (off.dot(z.covariance.ldlt().solve(off)) < kPresentShapeChi2) T = now;
    }
    solver.addFactor(RelativePoseCost::Create(T, z.covariance), {states.at(z.from), states.at(z.to)});
  }
  if (!graph.ups.empty()) {
    const auto up = solver.addSharedUnitVector(graph.up_map);
    for (const UpFactor& f : graph.ups)
      solver.addFactor(UpCost::Create(f.up_body, f.sigma_rad), {states.at(f.keyframe), up});
  }
  solver.solve(true);
  std::map<KeyframeId, SE3> poses;
  for (const auto& [id, state] : states) poses[id] = solver.pose(state);
  return poses;
}

}  // namespace

std::map<KeyframeId, SE3> bentToLoops(const SituationalGraph& graph) {
  return solved(graph, true);
}

std::map<KeyframeId, SE3> poseGraphOptimum(const SituationalGraph& graph) {
  return solved(graph, false);
}

std::map<KeyframeId, Matrix6d> covariancesAlongBestWay(const SituationalGraph& graph, KeyframeId of) {
  struct Step {
    KeyframeId to;
    const RelativePose* z;
  };
  std::map<KeyframeId, std::vector<Step>> steps;
  for (const RelativePoseFactor& f : graph.relative_poses) {
    steps[f.measurement.from].push_back({f.measurement.to, &f.measurement});
    steps[f.measurement.to].push_back({f.measurement.from, &f.measurement});
  }
  // Dijkstra by the trace; ties by id.
  struct Reached {
    SE3 T_of_here;
    Matrix6d covariance;  // of that, tangent of body here
  };
  std::map<KeyframeId, Reached> reached = {{of, {{}, Matrix6d::Zero()}}};
  std::set<std::pair<double, KeyframeId>> open = {{0.0, of}};
  std::map<KeyframeId, Matrix6d> done;
  while (!open.empty()) {
    const KeyframeId here = open.begin()->second;
    open.erase(open.begin());
    const Reached at = reached.at(here);
    const Matrix6d Ad = se3Adjoint(at.T_of_here);
    done[here] = Ad * at.covariance * Ad.transpose();
    for (const Step& step : steps[here]) {
      if (done.contains(step.to)) continue;
      const bool forth = step.z->from == here;
      const SE3 T = forth ? step.z->T_from_to : step.z->T_from_to.inverse();
      const Matrix6d Adz = forth ? Matrix6d(Matrix6d::Identity()) : se3Adjoint(step.z->T_from_to);
      const Reached next{at.T_of_here * T,
                         composeCovariance(at.covariance, T, Adz * step.z->covariance * Adz.transpose())};
      const auto known = reached.find(step.to);
      if (known != reached.end()) {
        if (known->second.covariance.trace() <= next.covariance.trace()) continue;
        open.erase({known->second.covariance.trace(), step.to});
      }
      reached[step.to] = next;
      open.insert({next.covariance.trace(), step.to});
    }
  }
  return done;
}

}  // namespace sgraphs
