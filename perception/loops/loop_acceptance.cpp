#include "perception/loops/loop_acceptance.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sgraphs {
namespace {

constexpr size_t kMaxCandidates = 24;  // that are weighed against each other
constexpr double kWait_m = 60.0;       // of path that a lone loop waits for a second one
constexpr double kElsewhere_m = 1.5;   // of path between two looks that count as two
constexpr double kLikelyFloor_m = 0.30;

}  // namespace

void LoopAcceptance::forget(double walked_m, const WalkedPath& path) {
  while (!possible_.empty() && walked_m - path.walkedTo(possible_.front().to) > config_.rival_memory_m)
    possible_.pop_front();
  std::erase_if(candidates_, [&](const Candidate& c) {
    return !c.accepted && walked_m - path.walkedTo(c.hypothesis.loop.to) > kWait_m;
  });
  while (candidates_.size() > kMaxCandidates) candidates_.pop_front();
}

void LoopAcceptance::remove(KeyframeId from, KeyframeId to) {
  std::erase_if(candidates_, [&](const Candidate& c) {
    return c.hypothesis.loop.from == from && c.hypothesis.loop.to == to;
  });
  std::erase_if(possible_, [&](const MeasuredLoop& m) { return m.from == from && m.to == to; });
}

bool LoopAcceptance::contradicted(const Candidate& candidate, const WalkedPath& path) const {
  return std::any_of(possible_.begin(), possible_.end(), [&](const MeasuredLoop& other) {
    return !consistent(candidate.hypothesis.loop, other, path);
  });
}

LoopAcceptance::Change LoopAcceptance::step(const LoopVerdict& verdict, const WalkedPath& path) {
  const LoopVerificationConfig& v = config_.verification;
  forget(path.walkedTo(verdict.keyframe), path);
  Change change;
  // What else comes close to the best may be the true one as well.
  std::vector<const LoopHypothesis*> alike;
  for (const LoopHypothesis& h : verdict.hypotheses)
    if (h.check.quality() >= verdict.hypotheses.front().check.quality() - v.rival_margin) alike.push_back(&h);
  const bool proven = !alike.empty() && alike.front()->check.alike(v) && alike.front()->check.fixed(v);
  if (proven)
    for (const LoopHypothesis* h : alike)
      if (h->check.fixed(v)) possible_.push_back(h->loop);
  if (proven && alike.size() == 1) {
    Candidate c;
    c.hypothesis = *alike.front();
    c.likely = c.hypothesis.correction_m <= kLikelyFloor_m + config_.likely_share * c.hypothesis.gate_m;
    c.map_refuted = verdict.map_refuted;
    if (c.likely || c.map_refuted) candidates_.push_back(c);
  }
  const size_t n = candidates_.size();
  if (n == 0) return change;

  std::vector<uint64_t> neighbours(n, 0);
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < i; ++j)
      if (consistent(candidates_[i].hypothesis.loop, candidates_[j].hypothesis.loop, path)) {
        neighbours[i] |= uint64_t{1} << j;
        neighbours[j] |= uint64_t{1} << i;
      }
  const uint64_t best = largestClique(neighbours);
  const auto in = [&](size_t i) { return ((best >> i) & 1) != 0; };
  // Whether another loop of the set was seen from elsewhere.
  const auto confirmed = [&](size_t i) {
    for (size_t j = 0; j < n; ++j)
      if (j != i && in(j) &&
          std::abs(path.walkedTo(candidates_[i].hypothesis.loop.to) -
                   path.walkedTo(candidates_[j].hypothesis.loop.to)) >= kElsewhere_m)
        return true;
    return false;
  };
  std::vector<bool> drop(n, false);
  for (size_t i = 0; i < n; ++i) {
    Candidate& c = candidates_[i];
    if (in(i)) {
      if (c.accepted || contradicted(c, path) || !(c.likely || confirmed(i))) continue;
      c.accepted = true;
      change.accepted.push_back(c.hypothesis.loop);
      change.evidence.push_back(c.hypothesis);
    } else if (c.accepted) {
      // Only a larger set overrules what was accepted: the largest that contains it must be smaller.
      std::vector<uint64_t> with(neighbours);
      for (size_t j = 0; j < n; ++j) with[j] &= neighbours[i];
      for (size_t j = 0; j < n; ++j)
        if (((neighbours[i] >> j) & 1) == 0) with[j] = 0;
      const int own = 1 + (neighbours[i] ? std::popcount(largestClique(with)) : 0);
      if (own >= std::popcount(best)) continue;
      change.withdrawn.push_back(c.hypothesis.loop);
      drop[i] = true;
    }
  }
  std::deque<Candidate> kept;
  for (size_t i = 0; i < n; ++i)
    if (!drop[i]) kept.push_back(candidates_[i]);
  candidates_ = std::move(kept);
  return change;
}

}  // namespace sgraphs
