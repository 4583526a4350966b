#include "backend/backend.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "backend/graph_builder.h"
#include "backend/keyframe_admission.h"
#include "backend/levelling.h"
#include "backend/loops/loop_layer.h"
#include "backend/loops/pose_graph.h"
#include "backend/planes/plane_layer.h"
#include "backend/planes/shared_information.h"
#include "backend/rooms/floor_layer.h"
#include "backend/rooms/room_changes.h"
#include "backend/rooms/room_layer.h"

namespace sgraphs {
namespace {

// The map is levelled once more with what the first rounds saw of `up`, before walls depend on it.
constexpr int64_t kRelevelRound = 3;
// Keyframes are announced again when they moved by more than this.
constexpr double kAnnounceStep_m = 1e-3;
constexpr double kAnnounceStep_rad = 1e-4;
// Loops that are switched off or on in one round at most; each costs a solve of the whole graph.
constexpr int kMaxJudgements = 5;
// The covariance is propagated to first order about states that still move a little.
constexpr double kCovarianceMargin = 1.02;

bool moved(const SE3& a, const SE3& b) {
  return (a.translation - b.translation).norm() > kAnnounceStep_m ||
         a.rotation.angularDistance(b.rotation) > kAnnounceStep_rad;
}

SolverOptions solverOptions(const BackendConfig& config) {
  SolverOptions options;
  options.max_iterations = config.max_iterations;
  return options;
}

// T exp(d) inverted is T^-1 exp(-Ad(T) d).
RelativePose reversed(const RelativePose& z) {
  RelativePose out = z;
  const Matrix6d Ad = se3Adjoint(z.T_from_to);
  std::swap(out.from, out.to);
  out.T_from_to = z.T_from_to.inverse();
  out.covariance = Ad * z.covariance * Ad.transpose();
  return out;
}

// What a new keyframe's pose and covariance are derived from, as a measurement of it: odometry, else a
// neighbour (admit() sees to it that there is one or the other), from the latest keyframe.
RelativePose anchorOf(KeyframeId id, const std::vector<RelativePose>& measurements) {
  const RelativePose* best = nullptr;
  const auto rank = [](const RelativePose& z) {
    return std::make_pair(-static_cast<int>(z.kind), std::min(z.from, z.to));
  };
  for (const RelativePose& z : measurements) {
    if (z.kind == RelativePoseKind::kLoop || (z.from != id && z.to != id)) continue;
    if (best == nullptr || rank(z) > rank(*best)) best = &z;
  }
  if (best == nullptr) throw std::logic_error("backend: keyframe " + id.str() + " is tied to nothing");
  return best->to == id ? *best : reversed(*best);
}

}  // namespace

class Backend::Impl {
 public:
  explicit Impl(const BackendConfig& config)
      : builder_(solverOptions(config)),
        planes_(config.planes, builder_),
        loops_(config.loops, builder_),
        rooms_(config.rooms, builder_, planes_),
        floors_(config.floors, config.rooms.wall_sigma_m, config.rooms.along_sigma_m, builder_) {}

  RoundOutput step(RoundInput input) {
    RoundOutput output;
    if (input.round >= kRelevelRound) relevelOnce();
    const bool idle = !input.keyframe;
    // First: what is new is then compared with the map as it is with them.
    if (input.loops && !graph().keyframes.empty()) {
      const LoopLayer::Change change = loops_.apply(*input.loops, output.refused);
      if (change != LoopLayer::Change::kNone) mend(change);
    }
    const std::optional<Rooms> rooms = std::move(input.rooms);
    if (input.free_space) builder_.setFreeSpace(std::move(input.free_space));
    bool whole = !idle && add(std::move(input), output);
    if (rooms && !graph().keyframes.empty()) whole = addRooms(*rooms, output) || whole;
    whole = whole || (idle && !builder_.solver().settled());
    solve(whole, idle, output);
    announce(output);
    output.graph_digest = graph().digest();
    return output;
  }

  const SituationalGraph& graph() const { return builder_.graph(); }
  std::map<std::string, FactorStatistics> factorStatistics() const { return builder_.statistics(); }

  std::map<KeyframeId, Matrix6d> keyframeCovariances() const { return builder_.keyframeCovariances(); }

 private:
  // Loops came, went, or were judged anew: solves the whole graph, until it and they agree.
  void mend(LoopLayer::Change change) {
    for (int i = 0; change != LoopLayer::Change::kNone && i < kMaxJudgements; ++i) {
      if (change == LoopLayer::Change::kSmall) {
        builder_.solve(true);
      } else {
        const bool unbend = change == LoopLayer::Change::kUndone;
        builder_.moveKeyframes(unbend ? poseGraphOptimum(graph()) : bentToLoops(graph()));
        if (unbend) planes_.mapUnbent();
        builder_.solveFromAfar();
      }
      change = loops_.judge();
    }
    const KeyframeId newest = graph().keyframes.rbegin()->first;
    planes_.mapMended(covariancesAlongBestWay(graph(), newest));
    mended_ = true;
  }

  // True if the round needs the whole graph.
  bool add(RoundInput input, RoundOutput& output) {
    Admission admission = admit(*input.keyframe, graph());
    output.refused.insert(output.refused.end(), admission.refused.begin(), admission.refused.end());
    output.bridged = admission.bridged;
    if (!admission.accepted) return false;
    const KeyframeId id = input.keyframe->id;
    for (RelativePose& z : admission.relative_poses)
      if (leavesHeightOpen(z) && z.to == id)
        z = alongVertical(z, graph().keyframes.at(z.from).T_map_body, graph().up_map);
    addKeyframe(std::move(*input.keyframe), admission);

    std::optional<PlaneLayer::Sighting> sighting;
    if (input.planes && input.planes->keyframe == id) sighting = planes_.associate(id, *input.planes);
    bool whole = false;
    for (RelativePose& z : admission.relative_poses) {
      if (z.registered && z.to == id && sighting)
        z.covariance =
            withoutSharedInformation(z.covariance, sighting->information, planes_.shared_information());
      builder_.addRelativePose(z);
      whole = GraphBuilder::closesCircle(z) || whole;
    }
    const Keyframe& keyframe = *graph().keyframes.at(id).keyframe;
    if (admission.has_up) builder_.addUp(id, keyframe.up_body, keyframe.up_sigma_rad);
    if (sighting) {
      output.refused.insert(output.refused.end(), sighting->refused.begin(), sighting->refused.end());
      whole = planes_.add(id, *sighting) || whole;
    }
    return whole;
  }

  // True if the round needs the whole graph.
  bool addRooms(const Rooms& rooms, RoundOutput& output) {
    const auto refuse = [&](const std::vector<std::string>& lines) {
      output.refused.insert(output.refused.end(), lines.begin(), lines.end());
    };
    refuse(floors_.assign(rooms));
    // Places in a map that was not levelled yet are no places of this one.
    if (rooms.round < kRelevelRound) return false;
    const RoomLayer::Outcome outcome = rooms_.apply(rooms);
    refuse(outcome.refused);
    floors_.bind(rooms);
    return outcome.merged;
  }

  void addKeyframe(Keyframe keyframe, const Admission& admission) {
    KeyframeNode node;
    node.id = keyframe.id;
    node.time = keyframe.time;
    node.T_odom_body = keyframe.T_odom_body;
    if (graph().keyframes.empty()) {
      node.floor = FloorId{0};
      builder_.addFloor(node.floor);
      node.T_map_body.rotation =
          admission.has_up ? levelledRotation(keyframe.up_body) : Eigen::Quaterniond::Identity();
      node.keyframe = std::make_shared<const Keyframe>(std::move(keyframe));
      builder_.addKeyframe(std::move(node));
      return;
    }
    const RelativePose z = anchorOf(keyframe.id, admission.relative_poses);
    const KeyframeId last = graph().keyframes.rbegin()->first;
    const KeyframeNode& from = graph().keyframes.at(z.from);
    // That of the start is f0; a later keyframe is on the storey of the one it is measured from until it is
    // told otherwise.
    node.floor = from.floor;
    if (node.floor.valid()) builder_.addFloor(node.floor);
    node.T_map_body = from.T_map_body * z.T_from_to;
    // By that one measurement: further factors could only lower it.
    node.covariance = composeCovariance(from.covariance, z.T_from_to, z.covariance);
    node.keyframe = std::make_shared<const Keyframe>(std::move(keyframe));
    builder_.addKeyframe(std::move(node));
    if (z.from != last) planes_.carriedTo(covariancesAlongBestWay(graph(), z.from));
    planes_.advance(z);
    loops_.advance(z);
  }

  void relevelOnce() {
    if (relevelled_) return;
    relevelled_ = true;
    builder_.relevel();
  }

  void solve(bool whole, bool idle, RoundOutput& output) {
    const IncrementalSolver::Report report = builder_.solve(whole);
    output.whole_graph = report.whole || std::exchange(mended_, false);
    if (graph().keyframes.empty()) return;
    if (report.whole && report.converged)
      if (const LoopLayer::Change change = loops_.judge(); change != LoopLayer::Change::kNone) mend(change);
    planes_.settle(report.whole, idle);
    const KeyframeId newest = graph().keyframes.rbegin()->first;
    // A factorisation costs as much as a solve, and only ever lowers them.
    if (builder_.solver().settled() && (idle || report.whole)) {
      if (newest != graph().keyframes.begin()->first)
        if (const auto covariance = builder_.covariance(newest)) builder_.setCovariance(newest, *covariance);
      if (idle) planes_.refreshCovariances();
    }
    output.keyframe_covariance = kCovarianceMargin * graph().keyframes.at(newest).covariance;
  }

  void announce(RoundOutput& output) {
    if (graph().keyframes.empty()) return;
    const KeyframeNode& newest = graph().keyframes.rbegin()->second;
    output.T_map_odom = newest.T_map_body * newest.T_odom_body.inverse();
    for (const auto& [id, node] : graph().keyframes) {
      const auto known = announced_.find(id);
      const bool still = known != announced_.end() && known->second.second == node.floor &&
                         !moved(known->second.first, node.T_map_body);
      if (still) continue;
      announced_[id] = {node.T_map_body, node.floor};
      output.changed.push_back(id);
    }
    output.changed_planes = planes_.takeChanged();
    output.changed_rooms = room_changes_.take(graph());
  }

  GraphBuilder builder_;
  PlaneLayer planes_;
  LoopLayer loops_;
  RoomLayer rooms_;
  FloorLayer floors_;
  RoomChanges room_changes_;
  bool relevelled_ = false;
  bool mended_ = false;                                      // in this round
  std::map<KeyframeId, std::pair<SE3, FloorId>> announced_;  // T_map_body as it was last made known, storey
};

Backend::Backend(const BackendConfig& config) : impl_(std::make_unique<Impl>(config)) {}
Backend::~Backend() = default;

RoundOutput Backend::step(RoundInput input) {
  return impl_->step(std::move(input));
}

const SituationalGraph& Backend::graph() const {
  return impl_->graph();
}

std::map<KeyframeId, Matrix6d> Backend::keyframeCovariances() const {
  return impl_->keyframeCovariances();
}

std::map<std::string, FactorStatistics> Backend::factorStatistics() const {
  return impl_->factorStatistics();
}

}  // namespace sgraphs
