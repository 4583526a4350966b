#include "perception/relocalise/candidates.h"

#include <algorithm>

namespace sgraphs {
namespace {

// What the map and two registrations may differ by, and what odometry may drift by along a metre.
constexpr double kSame_m = 0.25;
constexpr double kSame_rad = 0.04;
constexpr double kDrift_share = 0.03;
constexpr double kDrift_radpm = 0.005;
constexpr size_t kMaxCandidates = 32;
constexpr size_t kMaxLooks = 100;

}  // namespace

bool Candidates::same(const Candidate& candidate, const SE3& T_map_odom, const SE3& T_odom_body,
                      double at_m) {
  const double since_m = at_m - candidate.seen_m;
  const SE3 d = (candidate.T_map_odom * T_odom_body).inverse() * (T_map_odom * T_odom_body);
  return d.translation.norm() <= kSame_m + kDrift_share * since_m &&
         so3Log(d.rotation).norm() <= kSame_rad + kDrift_radpm * since_m;
}

void Candidates::add(const std::vector<Look>& looks, const SE3& T_odom_body, double at_m, bool complete) {
  complete_ = complete;
  std::vector<bool> seen(candidates_.size(), false), refuted(candidates_.size(), false);
  double best_quality = 0;
  for (const Look& look : looks)
    if (look.check.alike(verification_)) best_quality = std::max(best_quality, look.check.quality());
  std::vector<Candidate> fresh;
  for (const Look& look : looks) {
    const bool proves = look.check.alike(verification_) && look.check.fixed(verification_);
    const bool refutes = look.check.refuted(verification_);
    bool known = false;
    for (size_t i = 0; i < seen.size(); ++i) {
      Candidate& c = candidates_[i];
      if (seen[i] || !same(c, look.T_map_odom, T_odom_body, at_m)) continue;
      known = seen[i] = true;
      c.shortfall += std::max(0.0, best_quality - look.check.quality() - 0.5 * verification_.rival_margin);
      refuted[i] = refutes || c.shortfall > 2.0 * verification_.rival_margin;
      if (!proves) break;
      c.T_map_odom = look.T_map_odom;
      c.seen_m = at_m;
      if (c.looks.size() < kMaxLooks) c.looks.push_back(look);
      break;
    }
    if (!known && proves) fresh.push_back({look.T_map_odom, at_m, {look}, 0});
  }
  std::vector<Candidate> kept;
  for (size_t i = 0; i < seen.size(); ++i)
    if (!refuted[i]) kept.push_back(std::move(candidates_[i]));
  kept.insert(kept.end(), fresh.begin(), fresh.end());
  std::stable_sort(kept.begin(), kept.end(),
                   [](const Candidate& a, const Candidate& b) { return a.looks.size() > b.looks.size(); });
  if (kept.size() > kMaxCandidates) {
    kept.resize(kMaxCandidates);
    complete_ = false;
  }
  candidates_ = std::move(kept);
}

const Candidate* Candidates::found() const {
  if (!complete_ || candidates_.empty()) return nullptr;
  const Candidate& best = candidates_.front();
  const auto looks = static_cast<int>(best.looks.size());
  if (looks < config_.min_looks || best.looks.back().at_m - best.looks.front().at_m < config_.min_span_m)
    return nullptr;
  if (candidates_.size() < 2) return &best;
  // Where a rival was not looked at, the map may be lacking; that proves nothing against it.
  const auto rival = static_cast<int>(candidates_[1].looks.size());
  return looks >= rival + config_.lead && looks > 2 * rival ? &best : nullptr;
}

}  // namespace sgraphs
