#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "backend/factors/plane_state.h"
#include "common/geometry/se3.h"

namespace ceres {
class CostFunction;
}

namespace sgraphs {

struct SolverOptions {
  int max_iterations = 10;  // of one solve; the only budget there is (a time budget would not be repeatable)

  // What the held states at the rim of a neighbourhood would move alone is a fraction of what the chain
  // behind them would move together: in a circle of n equal links, one part in 2 n. So their steps are
  // multiplied by the number of held states, at most by this.
  int max_leverage = 30;
  // A neighbourhood grows while that product is above this.
  double grow_step_m = 1e-4;
  double grow_step_rad = 3e-5;
  // The products that rounds left unresolved since the last whole-graph solve, as root of the sum of squares,
  // and what shared states (`up`) would move: more than this calls for a whole-graph solve.
  double drift_m = 1e-3;
  double drift_rad = 1e-4;
  double shared_drift_rad = 1e-4;

  // In graphs with planes, what the neighbourhood pulls at is left alone below rest_step, passed on by a step
  // of the whole graph up to max_step, and a matter for a whole-graph solve above.
  double rest_step_m = 3e-4;
  double rest_step_rad = 3e-5;
  double max_step_m = 0.1;
  double max_step_rad = 5e-3;
  double drift_planes_m = 5e-3;  // as drift_m and drift_rad
  double drift_planes_rad = 3e-4;
  int max_region_planes = 100;  // states

  // Solves are done when the root mean square of their steps [m, rad] is below this.
  double settled_step_local = 1e-7;
  double settled_step_whole = 1e-5;

  int max_region = 400;  // states; a larger neighbourhood is not local any more
  int small_graph = 30;  // states; smaller graphs are solved whole, which costs nothing
};

// Nonlinear least squares over states on manifolds, grown factor by factor and solved in rounds: the
// neighbourhood of what is new, or the whole graph. Single-threaded and a pure function of its calls.
class IncrementalSolver {
 public:
  using StateId = int;   // dense, in order of creation
  using FactorId = int;  // dense, in order of creation

  struct Report {
    bool whole = false;
    bool converged = true;
    int iterations = 0;
    std::vector<StateId> free;  // states that were free to move, ascending
  };

  explicit IncrementalSolver(const SolverOptions& options);
  ~IncrementalSolver();

  StateId addPose(const SE3& T);
  StateId addPlane(const PlaneState& plane);
  // A direction shared by many factors: no path for neighbourhoods, and moved only with the whole graph.
  StateId addSharedUnitVector(const Eigen::Vector3d& n);
  // What the factors between other states do not depend on: the centre (x, y) of a room or a storey, the
  // height of a storey [m]. Factors of these are to determine them and nothing else: a change of such a
  // factor calls for a solve of the centres and heights in it only.
  StateId addCenter(const Eigen::Vector2d& center);
  StateId addHeight(double height_m);
  // Held states never move: the gauge.
  void hold(StateId state);

  // The cost's parameters in order. `cauchy_scale`: robust, quadratic up to about this residual norm.
  FactorId addFactor(std::unique_ptr<ceres::CostFunction> cost, const std::vector<StateId>& states,
                     std::optional<double> cauchy_scale = {});
  // A disabled factor has no part in solves, neighbourhoods and covariances; it keeps its id, and chi2()
  // still tells what its residual would be.
  void setEnabled(FactorId factor, bool enabled);
  bool enabled(FactorId factor) const;
  // Binds the factor to another state of the same kind. Throws std::logic_error if it has that one already.
  void rebind(FactorId factor, StateId from, StateId to);

  // Setting a state does not call for a solve by itself: the next one starts from there, and where there are
  // planes it is one of the whole graph.
  SE3 pose(StateId state) const;
  void setPose(StateId state, const SE3& T);
  PlaneState plane(StateId state) const;
  void setPlane(StateId state, const PlaneState& plane);
  Eigen::Vector3d unitVector(StateId state) const;
  void setUnitVector(StateId state, const Eigen::Vector3d& n);

  Eigen::Vector2d center(StateId state) const;
  double height(StateId state) const;

  // Solves the neighbourhood of the factors added since the last call, or the whole graph where `whole` asks
  // for it, a former whole-graph solve ran out of iterations, or too much was left unresolved.
  Report solve(bool whole);
  // True if the last solve was of the whole graph, converged, and nothing was added since.
  bool settled() const;

  // Squared norm of the factor's residual at the present states, without robust loss; its number of
  // residuals.
  double chi2(FactorId factor) const;
  int numResiduals(FactorId factor) const;

  // Marginal covariances at the present states, all others free; none if the factors leave a state
  // undetermined. The first call after a change costs a factorisation of the whole graph, each further one
  // two triangular solves by tangent direction. Zero for held states.
  std::optional<Matrix6d> covariance(StateId pose) const;
  // Of (tilt, tilt, offset) as PlaneManifold has them, at the plane's anchor.
  std::optional<Eigen::Matrix3d> planeCovariance(StateId plane) const;
  // Of several states together: blocks in their order, with the cross terms.
  std::optional<Eigen::MatrixXd> jointCovariance(const std::vector<StateId>& states) const;
  // Of all poses, or all planes, in about the time of one factorisation. Empty if a state is undetermined.
  std::map<StateId, Matrix6d> poseCovariances() const;
  std::map<StateId, Eigen::Matrix3d> planeCovariances() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgraphs
