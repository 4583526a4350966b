#include "perception/loops/loop_finder.h"

#include <algorithm>
#include <deque>
#include <map>

#include "perception/loops/floor_return.h"
#include "perception/loops/loop_acceptance.h"

namespace sgraphs {
namespace {

// A new keyframe's storey is told one round late, with the rooms that were made of it.
constexpr int64_t kSettled_rounds = 2;

}  // namespace

class LoopFinder::Impl {
 public:
  explicit Impl(const LoopsConfig& config)
      : config_(config),
        path_(config.gate),
        memory_(config.place_spacing_m, std::max(config.verification.query_path_m, config.gate.min_walked_m)),
        search_(config),
        acceptance_(config),
        floor_return_(config) {}

  LoopClosures step(const std::optional<Keyframe>& keyframe, const MapUpdate& update) {
    LoopClosures loops;
    loops.round = update.round;
    loops.time = update.time;
    if (!config_.enabled) return loops;
    memory_.apply(update);
    if (keyframe && !keyframe->points.empty() && memory_.known(keyframe->id)) {
      path_.add(*keyframe);
      memory_.add(*keyframe, path_);
      const double walked_m = path_.walkedTo(keyframe->id);
      if (walked_m - searched_m_ >= config_.search_spacing_m) {
        searched_m_ = walked_m;
        waiting_.push_back({keyframe->id, update.round + kSettled_rounds});
      }
    }
    if (!waiting_.empty() && waiting_.front().due_round <= update.round) {
      work(waiting_.front().keyframe, loops);
      waiting_.pop_front();
    }
    withdrawAcrossStoreys(loops);
    std::sort(loops.withdrawn.begin(), loops.withdrawn.end());
    loops.searching = !waiting_.empty();
    return loops;
  }

 private:
  void work(KeyframeId id, LoopClosures& loops) {
    for (const LoopHypothesis& h : floor_return_.step(id, memory_, path_)) accept(h.loop, h.check, loops);
    // Little is learnt from loops that follow closely.
    if (path_.walkedTo(id) - looped_m_ < config_.spacing_m) return;
    const LoopAcceptance::Change change = acceptance_.step(search_.step(id, memory_, path_), path_);
    for (size_t i = 0; i < change.accepted.size(); ++i)
      accept(change.accepted[i], change.evidence[i].check, loops);
    for (const MeasuredLoop& m : change.withdrawn) withdraw(m.from, m.to, loops);
  }

  void accept(const MeasuredLoop& m, const LoopCheck& check, LoopClosures& loops) {
    LoopClosure loop;
    loop.id = LoopId{next_id_++};
    loop.pose.kind = RelativePoseKind::kLoop;
    loop.pose.from = m.from;
    loop.pose.to = m.to;
    loop.pose.T_from_to = m.T_from_to;
    loop.pose.covariance = m.covariance;
    loop.overlap = std::clamp(check.overlap, 0.0, 1.0);
    loop.inlier_share = std::clamp(check.inlier_share, 0.0, 1.0);
    loops.accepted.push_back(loop);
    ids_[{m.from, m.to}] = loop.id;
    path_.link(m.from, m.to);
    looped_m_ = std::max(looped_m_, path_.walkedTo(m.to));
  }

  void withdraw(KeyframeId from, KeyframeId to, LoopClosures& loops) {
    const auto it = ids_.find({from, to});
    if (it == ids_.end()) return;
    loops.withdrawn.push_back(it->second);
    ids_.erase(it);
    path_.unlink(from, to);
  }

  // A climb may come to light late: what was joined by then is taken back. What joins floors across a ride in
  // a lift has two floors at its ends until they have become one.
  void withdrawAcrossStoreys(LoopClosures& loops) {
    std::vector<std::pair<KeyframeId, KeyframeId>> across;
    for (const auto& [ends, id] : ids_) {
      const FloorId a = memory_.poseOf(ends.first).floor, b = memory_.poseOf(ends.second).floor;
      const bool ridden = path_.ridesBefore(ends.first) != path_.ridesBefore(ends.second);
      if (a.valid() && b.valid() && a != b && !ridden) across.push_back(ends);
    }
    for (const auto& [from, to] : across) {
      withdraw(from, to, loops);
      acceptance_.remove(from, to);
    }
  }

  struct Waiting {
    KeyframeId keyframe;
    int64_t due_round = 0;
  };

  LoopsConfig config_;
  WalkedPath path_;
  PlaceMemory memory_;
  LoopSearch search_;
  LoopAcceptance acceptance_;
  FloorReturn floor_return_;
  std::deque<Waiting> waiting_;
  std::map<std::pair<KeyframeId, KeyframeId>, LoopId> ids_;
  int64_t next_id_ = 0;
  double searched_m_ = 0;
  double looped_m_ = -1e9;  // where on the path the newest loop was accepted
};

LoopFinder::LoopFinder(const LoopsConfig& config) : impl_(std::make_unique<Impl>(config)) {}
LoopFinder::~LoopFinder() = default;

LoopClosures LoopFinder::step(const std::optional<Keyframe>& keyframe, const MapUpdate& update) {
  return impl_->step(keyframe, update);
}

}  // namespace sgraphs
