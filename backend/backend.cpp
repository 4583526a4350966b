#include "backend/backend.h"

#include <algorithm>
#include <stdexcept>

#include "backend/factors/relative_pose_cost.h"
#include "backend/factors/up_cost.h"
#include "backend/keyframe_admission.h"
#include "backend/levelling.h"
#include "backend/solver/incremental_solver.h"

namespace sgraphs {
namespace {

// The map is levelled once more with what the first rounds saw of `up`, before walls depend on it.
constexpr int64_t kRelevelRound = 3;
// Keyframes are announced again when they moved by more than this.
constexpr double kAnnounceStep_m = 1e-3;
constexpr double kAnnounceStep_rad = 1e-4;
// A neighbour factor over more keyframes than this closes a circle: its effect is not local.
constexpr int64_t kLocalSpan = 10;
// Loops are quadratic up to the 99 % quantile of chi-square with 6 degrees of freedom (16.8), a wrong one
// pulls less the further it is off (Cauchy).
constexpr double kLoopCauchyScale = 4.1;
// The covariance is propagated to first order about states that still move a little.
constexpr double kCovarianceMargin = 1.02;

bool moved(const SE3& a, const SE3& b) {
  return (a.translation - b.translation).norm() > kAnnounceStep_m ||
         a.rotation.angularDistance(b.rotation) > kAnnounceStep_rad;
}

const char* kindOf(const RelativePose& z) {
  if (z.kind == RelativePoseKind::kOdometry) return "odometry";
  return z.kind == RelativePoseKind::kNeighbour ? "neighbour" : "loop";
}

SolverOptions solverOptions(const BackendConfig& config) {
  SolverOptions options;
  options.max_iterations = config.max_iterations;
  return options;
}

}  // namespace

class Backend::Impl {
 public:
  explicit Impl(const BackendConfig& config) : solver_(solverOptions(config)) {}

  RoundOutput step(RoundInput input) {
    RoundOutput output;
    if (input.round >= kRelevelRound) relevelOnce();
    bool whole = !input.keyframe && !solver_.settled();
    if (input.keyframe) whole = add(std::move(*input.keyframe), output);
    solveRound(whole, output);
    announce(output);
    output.graph_digest = graph_.digest();
    return output;
  }

  const SituationalGraph& graph() const { return graph_; }

  std::map<KeyframeId, Matrix6d> keyframeCovariances(size_t most) const {
    std::map<KeyframeId, Matrix6d> covariances;
    const size_t stride = std::max<size_t>(1, (nodes_.size() + most - 1) / std::max<size_t>(1, most));
    size_t i = 0;
    for (const auto& [id, node] : nodes_)
      if (i++ % stride == 0 && id != nodes_.begin()->first)
        if (const auto covariance = solver_.covariance(node.state)) covariances.emplace(id, *covariance);
    return covariances;
  }

  std::map<std::string, FactorStatistics> factorStatistics() const {
    std::map<std::string, FactorStatistics> statistics{
        {"odometry", {}}, {"neighbour", {}}, {"loop", {}}, {"up", {}}};
    for (size_t i = 0; i < factor_kinds_.size(); ++i) {
      const auto factor = static_cast<IncrementalSolver::FactorId>(i);
      FactorStatistics& kind = statistics[factor_kinds_[i]];
      kind.count += 1;
      kind.dof += solver_.numResiduals(factor);
      kind.chi2 += solver_.chi2(factor);
    }
    return statistics;
  }

 private:
  struct NodeState {
    IncrementalSolver::StateId state = -1;
    SE3 announced;        // T_map_body as it was last made known
    Matrix6d covariance;  // an upper bound, from when the keyframe was the newest
  };

  // True if the round needs the whole graph.
  bool add(Keyframe keyframe, RoundOutput& output) {
    Admission admission = admit(keyframe, graph_);
    output.refused = std::move(admission.refused);
    output.bridged = admission.bridged;
    if (!admission.accepted) return false;
    addNode(std::move(keyframe), admission);
    bool whole = false;
    for (const RelativePose& z : admission.relative_poses) whole = addRelativePose(z) || whole;
    if (admission.has_up) addUp(graph_.keyframes.rbegin()->second);
    fresh_ = graph_.keyframes.rbegin()->first;
    return whole;
  }

  void addNode(Keyframe keyframe, const Admission& admission) {
    KeyframeNode node;
    node.id = keyframe.id;
    node.time = keyframe.time;
    node.T_odom_body = keyframe.T_odom_body;
    // The storey of the start is f0; later storeys come from measurements.
    node.floor = FloorId{0};
    graph_.floors.try_emplace(node.floor, FloorNode{.id = node.floor});
    node.T_map_body = initialPose(keyframe, admission);
    const bool first = graph_.keyframes.empty();
    NodeState& state = nodes_[node.id];
    state.state = solver_.addPose(node.T_map_body);
    state.announced = node.T_map_body;
    state.covariance.setZero();
    node_of_state_.push_back(nullptr);
    if (first) solver_.hold(state.state);
    node.keyframe = std::make_shared<const Keyframe>(std::move(keyframe));
    const KeyframeId id = node.id;
    node_of_state_.back() = &graph_.keyframes.emplace(id, std::move(node)).first->second;
  }

  SE3 initialPose(const Keyframe& keyframe, const Admission& admission) const {
    if (graph_.keyframes.empty())
      return {admission.has_up ? levelledRotation(keyframe.up_body) : Eigen::Quaterniond::Identity(),
              Eigen::Vector3d::Zero()};
    const RelativePose& z = anchor(keyframe.id, admission.relative_poses);
    if (z.to == keyframe.id) return graph_.keyframes.at(z.from).T_map_body * z.T_from_to;
    return graph_.keyframes.at(z.to).T_map_body * z.T_from_to.inverse();
  }

  // What a new keyframe's pose and covariance are derived from: odometry, else a neighbour (admit() sees to
  // it that there is one or the other), from the latest keyframe.
  static const RelativePose& anchor(KeyframeId id, const std::vector<RelativePose>& measurements) {
    const RelativePose* best = nullptr;
    const auto rank = [](const RelativePose& z) {
      return std::make_pair(-static_cast<int>(z.kind), std::min(z.from, z.to));
    };
    for (const RelativePose& z : measurements) {
      if (z.kind == RelativePoseKind::kLoop || (z.from != id && z.to != id)) continue;
      if (best == nullptr || rank(z) > rank(*best)) best = &z;
    }
    if (best == nullptr) throw std::logic_error("backend: keyframe " + id.str() + " is tied to nothing");
    return *best;
  }

  bool addRelativePose(const RelativePose& z) {
    const bool loop = z.kind == RelativePoseKind::kLoop;
    solver_.addFactor(RelativePoseCost::Create(z.T_from_to, z.covariance),
                      {nodes_.at(z.from).state, nodes_.at(z.to).state},
                      loop ? std::optional<double>(kLoopCauchyScale) : std::nullopt);
    factor_kinds_.push_back(kindOf(z));
    graph_.relative_poses.push_back({next_factor_++, z});
    return loop || std::abs(z.from.value - z.to.value) > kLocalSpan;
  }

  void addUp(const KeyframeNode& node) {
    const Keyframe& keyframe = *node.keyframe;
    if (up_state_ < 0) {
      graph_.up_map = node.T_map_body.rotation * keyframe.up_body;
      up_state_ = solver_.addSharedUnitVector(graph_.up_map);
      node_of_state_.push_back(nullptr);
    }
    solver_.addFactor(UpCost::Create(keyframe.up_body, keyframe.up_sigma_rad),
                      {nodes_.at(node.id).state, up_state_});
    factor_kinds_.push_back("up");
    graph_.ups.push_back({next_factor_++, node.id, keyframe.up_body, keyframe.up_sigma_rad});
  }

  // Turns the map about the first keyframe so that `up` is z again and the first keyframe keeps its heading.
  // Residuals do not change: the whole map turns.
  void relevelOnce() {
    if (relevelled_) return;
    relevelled_ = true;
    if (up_state_ < 0) return;
    const SE3 first = graph_.keyframes.begin()->second.T_map_body;
    const Eigen::Quaterniond levelled = levelledRotation(first.rotation.conjugate() * graph_.up_map);
    const SE3 T_new_old = SE3(levelled, first.translation) * first.inverse();
    for (auto& [id, node] : graph_.keyframes) {
      node.T_map_body = T_new_old * node.T_map_body;
      solver_.setPose(nodes_.at(id).state, node.T_map_body);
    }
    graph_.up_map = Eigen::Vector3d::UnitZ();
    solver_.setUnitVector(up_state_, graph_.up_map);
  }

  void solveRound(bool whole, RoundOutput& output) {
    const IncrementalSolver::Report report = solver_.solve(whole);
    output.whole_graph = report.whole;
    for (const IncrementalSolver::StateId state : report.free)
      if (state != up_state_) keyframeOf(state).T_map_body = solver_.pose(state);
    if (up_state_ >= 0) graph_.up_map = solver_.unitVector(up_state_);
    if (graph_.keyframes.empty()) return;

    const KeyframeId newest = graph_.keyframes.rbegin()->first;
    if (fresh_.valid()) propagateCovariance(newest);
    if (report.whole && report.converged) {
      NodeState& node = nodes_.at(newest);
      if (const auto covariance = solver_.covariance(node.state)) node.covariance = *covariance;
    }
    fresh_ = KeyframeId{};
    output.keyframe_covariance = kCovarianceMargin * nodes_.at(newest).covariance;
  }

  // From the keyframe it was measured against, by that one measurement: further factors could only lower it.
  void propagateCovariance(KeyframeId id) {
    std::vector<RelativePose> measurements;
    for (auto it = graph_.relative_poses.rbegin();
         it != graph_.relative_poses.rend() && (it->measurement.from == id || it->measurement.to == id); ++it)
      measurements.push_back(it->measurement);
    if (measurements.empty()) return;  // the first keyframe is certain: it defines the map
    RelativePose z = anchor(id, measurements);
    if (z.to != id) z = reversed(z);
    const SE3 T_from_to =
        graph_.keyframes.at(z.from).T_map_body.inverse() * graph_.keyframes.at(id).T_map_body;
    // The measurement's own perturbation, seen as one of the estimate.
    const Matrix6d J = se3RightJacobian(se3Log(z.T_from_to.inverse() * T_from_to));
    nodes_.at(id).covariance =
        composeCovariance(nodes_.at(z.from).covariance, T_from_to, J * z.covariance * J.transpose());
  }

  // T exp(d) inverted is T^-1 exp(-Ad(T) d).
  static RelativePose reversed(const RelativePose& z) {
    RelativePose out = z;
    const Matrix6d Ad = se3Adjoint(z.T_from_to);
    std::swap(out.from, out.to);
    out.T_from_to = z.T_from_to.inverse();
    out.covariance = Ad * z.covariance * Ad.transpose();
    return out;
  }

  void announce(RoundOutput& output) {
    if (graph_.keyframes.empty()) return;
    const KeyframeNode& newest = graph_.keyframes.rbegin()->second;
    output.T_map_odom = newest.T_map_body * newest.T_odom_body.inverse();
    auto state = nodes_.begin();
    for (const auto& [id, node] : graph_.keyframes) {
      NodeState& known = (state++)->second;
      if (!moved(known.announced, node.T_map_body) && id <= announced_up_to_) continue;
      known.announced = node.T_map_body;
      output.changed.push_back(id);
    }
    announced_up_to_ = newest.id;
  }

  KeyframeNode& keyframeOf(IncrementalSolver::StateId state) {
    return *node_of_state_.at(static_cast<size_t>(state));
  }

  SituationalGraph graph_;
  IncrementalSolver solver_;
  std::map<KeyframeId, NodeState> nodes_;
  std::vector<KeyframeNode*> node_of_state_;  // null for states that are not keyframes
  std::vector<std::string> factor_kinds_;     // by factor of the solver
  IncrementalSolver::StateId up_state_ = -1;
  int64_t next_factor_ = 0;
  bool relevelled_ = false;
  KeyframeId fresh_;  // added in this round
  KeyframeId announced_up_to_;
};

Backend::Backend(const BackendConfig& config) : impl_(std::make_unique<Impl>(config)) {}
Backend::~Backend() = default;

RoundOutput Backend::step(RoundInput input) {
  return impl_->step(std::move(input));
}

const SituationalGraph& Backend::graph() const {
  return impl_->graph();
}

std::map<KeyframeId, Matrix6d> Backend::keyframeCovariances(size_t most) const {
  return impl_->keyframeCovariances(most);
}

std::map<std::string, FactorStatistics> Backend::factorStatistics() const {
  return impl_->factorStatistics();
}

}  // namespace sgraphs
