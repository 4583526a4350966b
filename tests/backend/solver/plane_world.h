#pragma once

#include <ceres/cost_function.h>
#include <ceres/problem.h>

#include <array>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "backend/solver/incremental_solver.h"
#include "common/types/plane.h"

namespace sgraphs::testing_support {

struct PlaneWorldOptions {
  int num_keyframes = 300;
  int per_lap = 100;  // keyframes of one way around, 1 m apart: later laps see the old walls again
  int num_planes = 90;
  int seen_per_keyframe = 10;   // the nearest ones; the last of them is the floor, seen from everywhere
  bool structure = true;        // walls in pairs of faces, plumb; floors level, two of them at one height; up
  int relative_loop_every = 0;  // keyframes with a measured pose of one lap before; 0: none
  uint32_t seed = 1;
  double sigma_m = 0.01;  // of odometry
  double sigma_rad = 0.001;
  double plane_sigma_m = 0.01;
  double plane_sigma_rad = 0.003;
};

// What one keyframe adds, with noise drawn from the covariances stated.
struct PlaneWorldRound {
  struct Relative {
    int from = 0;
    SE3 T_from_to;
    Matrix6d covariance;
  };
  struct Seen {
    int plane = 0;
    PlaneObservation observation;
  };
  std::vector<Relative> relatives;  // odometry first
  std::vector<Seen> seen;
  Eigen::Vector3d up_body = Eigen::Vector3d::UnitZ();
};

struct PlaneWorld {
  PlaneWorldOptions options;
  std::vector<SE3> truth;          // T_map_body
  std::vector<PlaneState> planes;  // the first two are floors; then walls, 2 i and 2 i + 1 the faces of one
  std::vector<PlaneWorldRound> rounds;
};

PlaneWorld makePlaneWorld(const PlaneWorldOptions& options);

// An incremental solver fed round by round with a world, and every factor once more for a batch solution.
class PlaneRun {
 public:
  PlaneRun(const PlaneWorld& world, const SolverOptions& options);

  // Adds keyframe k and what it brings, without a solve.
  void addRound(int k);
  IncrementalSolver& solver() { return solver_; }
  int poseState(int k) const { return poses_[static_cast<size_t>(k)]; }
  int planeState(int plane) const { return planes_[static_cast<size_t>(plane)]; }  // -1: not seen yet

  struct Factor {
    std::function<std::unique_ptr<ceres::CostFunction>()> create;
    std::vector<int> states;
    IncrementalSolver::FactorId id = -1;
  };
  const std::vector<Factor>& factors() const { return factors_; }

  // The same factors, without the disabled ones, at the solver's states as a plain Ceres problem. The first
  // pose is constant.
  struct Batch {
    ceres::Problem problem;
    std::deque<std::array<double, 7>> blocks;
    std::map<int, double*> poses, planes;  // by state of the solver
    double* up = nullptr;

    explicit Batch(const PlaneRun& run);
  };
  // How far the solver's states are from the optimum found by plain Ceres from there.
  struct Distance {
    double m = 0, rad = 0;              // of the worst keyframe
    double plane_m = 0, plane_rad = 0;  // of the worst plane: its offset and its tilt
    double chi2_per_dof = 0;            // what the solver has more
    double batch_chi2_per_dof = 0;
  };
  Distance distanceFromBatch() const;

 private:
  void add(std::function<std::unique_ptr<ceres::CostFunction>()> create, std::vector<int> states);
  void addObservation(int k, const PlaneWorldRound::Seen& seen);
  void addStructure(int plane);

  const PlaneWorld& world_;
  IncrementalSolver solver_;
  std::vector<int> poses_, planes_;
  int up_ = -1;
  std::vector<Factor> factors_;
};

}  // namespace sgraphs::testing_support
