#include "perception/loops/walked_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace sgraphs {

WalkedPath::Uncertainty WalkedPath::Uncertainty::operator+(const Uncertainty& o) const {
  return {walked_m + o.walked_m, share_m + o.share_m, share_rad + o.share_rad, variance_m2 + o.variance_m2,
          variance_rad2 + o.variance_rad2};
}

void WalkedPath::add(const Keyframe& keyframe) {
  Node n;
  n.id = keyframe.id;
  n.T_odom_body = keyframe.T_odom_body;
  if (!nodes_.empty()) {
    const Node& previous = nodes_.back();
    double step_m = (keyframe.T_odom_body.translation - previous.T_odom_body.translation).norm();
    Uncertainty& u = n.since_previous;
    n.rides = previous.rides;
    bool registered = false;
    Vector6d variance = Vector6d::Zero();
    double best = std::numeric_limits<double>::infinity();
    for (RelativePose r : keyframe.relative_poses) {
      if (r.from != previous.id) continue;
      // Gates lie on one floor.
      if (leavesHeightOpen(r)) {
        ++n.rides;
        r.covariance.row(2).setZero();
        r.covariance.col(2).setZero();
        step_m = (keyframe.T_odom_body.translation - previous.T_odom_body.translation).head<2>().norm();
      }
      if (r.covariance.trace() < best) {
        best = r.covariance.trace();
        variance = r.covariance.diagonal();
      }
      if (r.kind != RelativePoseKind::kOdometry) continue;
      registered = r.registered;
      u.variance_m2 = r.covariance.topLeftCorner<3, 3>().trace();
      u.variance_rad2 = r.covariance.bottomRightCorner<3, 3>().trace();
    }
    if (!registered) n.variance = variance;
    u.walked_m = step_m;
    u.share_m = step_m * (registered ? config_.registered_share : config_.legs_share);
    u.share_rad = step_m * (registered ? config_.registered_rad_per_m : config_.legs_rad_per_m);
    n.walked_m = previous.walked_m + step_m;
  }
  nodes_.push_back(std::move(n));
}

int WalkedPath::indexOf(KeyframeId id) const {
  const auto it = std::lower_bound(nodes_.begin(), nodes_.end(), id,
                                   [](const Node& n, KeyframeId key) { return n.id < key; });
  return it != nodes_.end() && it->id == id ? static_cast<int>(it - nodes_.begin()) : -1;
}

void WalkedPath::link(KeyframeId from, KeyframeId to) {
  const int a = indexOf(from), b = indexOf(to);
  nodes_.at(static_cast<size_t>(a)).linked.push_back(b);
  nodes_.at(static_cast<size_t>(b)).linked.push_back(a);
}

void WalkedPath::unlink(KeyframeId from, KeyframeId to) {
  const int a = indexOf(from), b = indexOf(to);
  const auto drop = [](std::vector<int>& linked, int other) {
    const auto it = std::find(linked.begin(), linked.end(), other);
    if (it != linked.end()) linked.erase(it);
  };
  drop(nodes_.at(static_cast<size_t>(a)).linked, b);
  drop(nodes_.at(static_cast<size_t>(b)).linked, a);
}

LoopGate WalkedPath::grown(const Uncertainty& u) const {
  // A heading that errs by a random walk of variance s^2 in all over a way of length L puts its end off by
  // s^2 L^2 / 3.
  const double variance_m2 = u.variance_m2 + u.variance_rad2 * u.walked_m * u.walked_m / 3.0;
  LoopGate gate;
  gate.walked_m = u.walked_m;
  gate.radius_m = u.share_m + config_.sigmas * std::sqrt(variance_m2);
  gate.yaw_rad = u.share_rad + config_.sigmas * std::sqrt(u.variance_rad2);
  return gate;
}

LoopGate WalkedPath::bounded(const LoopGate& gate) const {
  return {gate.walked_m, std::min(config_.max_m, config_.base_m + gate.radius_m),
          std::min(config_.max_rad, config_.base_rad + gate.yaw_rad)};
}

LoopGate WalkedPath::along(KeyframeId a, KeyframeId b) const {
  const int first = std::min(indexOf(a), indexOf(b)), last = std::max(indexOf(a), indexOf(b));
  Uncertainty u;
  for (int i = first + 1; i <= last; ++i) u = u + nodes_.at(static_cast<size_t>(i)).since_previous;
  return grown(u);
}

Matrix6d WalkedPath::distortionAt(KeyframeId id, double reach_m) const {
  const int here = indexOf(id);
  const double at_m = node(id).walked_m;
  Vector6d sum = Vector6d::Zero();
  for (int i = here; i > 0 && at_m - nodes_[static_cast<size_t>(i)].walked_m < reach_m; --i)
    sum += nodes_[static_cast<size_t>(i)].variance;
  for (size_t i = static_cast<size_t>(here) + 1; i < nodes_.size() && nodes_[i].walked_m - at_m < reach_m;
       ++i)
    sum += nodes_[i].variance;
  return Matrix6d((0.5 * sum).asDiagonal());
}

WalkedPath::Gates WalkedPath::gatesFrom(KeyframeId id) const {
  const size_t n = nodes_.size();
  std::vector<Uncertainty> ways(n);
  std::vector<double> length(n, std::numeric_limits<double>::infinity());
  std::set<std::pair<double, int>> open;
  const int start = indexOf(id);
  length.at(static_cast<size_t>(start)) = 0;
  open.insert({0.0, start});
  const auto reach = [&](int from, int to, const Uncertainty& step) {
    const Uncertainty way = ways[static_cast<size_t>(from)] + step;
    double& known = length[static_cast<size_t>(to)];
    if (way.walked_m >= known) return;
    open.erase({known, to});
    known = way.walked_m;
    ways[static_cast<size_t>(to)] = way;
    open.insert({known, to});
  };
  while (!open.empty()) {
    const int i = open.begin()->second;
    open.erase(open.begin());
    const Node& here = nodes_[static_cast<size_t>(i)];
    if (i > 0) reach(i, i - 1, here.since_previous);
    if (i + 1 < static_cast<int>(n)) reach(i, i + 1, nodes_[static_cast<size_t>(i) + 1].since_previous);
    for (const int j : here.linked) reach(i, j, Uncertainty());
  }
  Gates gates;
  gates.path_ = this;
  for (const Uncertainty& u : ways) gates.gates_.push_back(bounded(grown(u)));
  return gates;
}

}  // namespace sgraphs
