#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>

#include <array>
#include <deque>
#include <memory>
#include <vector>

#include "backend/factors/plane_manifold.h"
#include "backend/factors/pose_manifold.h"
#include "backend/factors/unit_vector_manifold.h"

namespace sgraphs {

enum class StateKind { kPose, kPlane, kUnitVector, kCenter, kHeight };

// Centres (x, y) and heights [m] follow what they are bound to: they are bound to no more than determines
// them, so they pull at nothing as long as they are free wherever one of those is.
inline bool follows(StateKind kind) {
  return kind == StateKind::kCenter || kind == StateKind::kHeight;
}

// Ceres keeps pointers to x, so states never move in memory.
struct State {
  StateKind kind = StateKind::kPose;
  bool held = false;
  bool shared = false;
  std::array<double, 7> x{};
  std::vector<int> factors;  // the enabled ones, ascending
};

struct Factor {
  std::unique_ptr<ceres::CostFunction> cost;
  std::unique_ptr<ceres::LossFunction> loss;  // null: quadratic
  std::vector<int> states;
  bool enabled = true;  // else its states do not know of it
};

// Length of a step: translation (of a plane: offset) and rotation parts, each zero for states that have none.
struct StepSize {
  double m = 0;
  double rad = 0;
};

// Small enough to need no heap: residuals by tangent or ambient coordinates of one state.
constexpr int kMaxResiduals = 8;
constexpr int kMaxCoordinates = 7;
constexpr size_t kMaxStates = 3;  // of one factor
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxResiduals, 1>;
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxResiduals, kMaxCoordinates>;

// A factor linearised in the tangents of its states, the robust loss applied as Ceres applies it where the
// loss is concave: residual and Jacobians times sqrt(rho').
struct Linearised {
  SmallVector residual;
  std::array<SmallMatrix, kMaxStates> jacobians;  // one per state; empty where not asked for
};

// J^T J and J^T r of one state, all others held.
struct NormalEquations {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
};

// States and the factors between them: the arena all parts of the solver work on.
class StateGraph {
 public:
  std::deque<State> states;
  std::vector<Factor> factors;

  int addState(StateKind kind);
  // Throws std::logic_error if a state comes twice, does not fit the cost's parameter, or does not exist.
  int addFactor(Factor factor);
  void setEnabled(int factor, bool enabled);
  // The factor's state `from` becomes `to`; throws as addFactor does.
  void rebind(int factor, int from, int to);

  ceres::Manifold* manifold(StateKind kind);
  const ceres::Manifold& manifold(StateKind kind) const;

  double chi2(int factor) const;
  // Jacobians for the state `only`, or for all of the factor's states if it is -1.
  Linearised linearise(int factor, int only = -1) const;
  NormalEquations normalEquations(int state) const;
  // The Gauss-Newton step of one state, all others held.
  StepSize newtonStep(int state) const;
  StepSize sizeOf(int state, const Eigen::VectorXd& step) const;
  // Moves x, a value of the state's kind, by a step of its tangent.
  void move(int state, const Eigen::VectorXd& step, std::array<double, 7>& x) const;
  // From x to the state.
  Eigen::VectorXd difference(int state, const std::array<double, 7>& x) const;

 private:
  void checkStates(const Factor& factor) const;
  void attach(int factor);
  void detach(int factor);

  PoseManifold pose_manifold_;
  PlaneManifold plane_manifold_;
  UnitVectorManifold unit_vector_manifold_;
  ceres::EuclideanManifold<2> center_manifold_;
  ceres::EuclideanManifold<1> height_manifold_;
};

}  // namespace sgraphs
