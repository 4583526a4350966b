#pragma once

#include <vector>

#include "common/types/keyframe.h"
#include "perception/loops/loops_config.h"

namespace sgraphs {

// How far off one keyframe's pose may be, seen from another.
struct LoopGate {
  double walked_m = 0;  // along the way between them that is known best
  double radius_m = 0;
  double yaw_rad = 0;
};

// The way of the robot, and how uncertainty grows along it: by the odometry's own covariance, which is
// overconfident and therefore taken several times, and by a share of the distance. Accepted loops are short
// cuts.
class WalkedPath {
 public:
  explicit WalkedPath(const LoopGateConfig& config) : config_(config) {}

  // In order of ids; ids may be missing.
  void add(const Keyframe& keyframe);
  bool contains(KeyframeId id) const { return indexOf(id) >= 0; }

  void link(KeyframeId from, KeyframeId to);
  void unlink(KeyframeId from, KeyframeId to);

  // Distance along the path [m] at which the keyframe stands, and its pose by odometry.
  double walkedTo(KeyframeId id) const { return node(id).walked_m; }
  const SE3& odometryOf(KeyframeId id) const { return node(id).T_odom_body; }
  // Number of rides in lifts before the keyframe: of measurements of a pose that leave the height open.
  int ridesBefore(KeyframeId id) const { return node(id).rides; }

  // Gates between `id` and all keyframes, by the shortest ways over the path and its loops.
  class Gates {
   public:
    LoopGate at(KeyframeId id) const { return gates_.at(static_cast<size_t>(path_->indexOf(id))); }

   private:
    friend class WalkedPath;
    const WalkedPath* path_ = nullptr;
    std::vector<LoopGate> gates_;
  };
  Gates gatesFrom(KeyframeId id) const;

  // Covariance of a body's pose within its own surroundings, which are made of the clouds along `reach_m` of
  // path to either side: what the measurements between them leave open, half of it. Nothing where the
  // odometry was registered: a local map does not bend so.
  Matrix6d distortionAt(KeyframeId id, double reach_m) const;

  // What the odometry alone between two keyframes may err by; no loops, no base.
  LoopGate along(KeyframeId a, KeyframeId b) const;

 private:
  // What a way adds up.
  struct Uncertainty {
    double walked_m = 0;
    double share_m = 0;
    double share_rad = 0;
    double variance_m2 = 0;
    double variance_rad2 = 0;
    Uncertainty operator+(const Uncertainty& other) const;
  };
  struct Node {
    KeyframeId id;
    double walked_m = 0;
    int rides = 0;
    SE3 T_odom_body;
    Uncertainty since_previous;
    Vector6d variance =
        Vector6d::Zero();  // of the best measurement against the previous one; zero if registered
    std::vector<int> linked;
  };
  int indexOf(KeyframeId id) const;
  const Node& node(KeyframeId id) const { return nodes_.at(static_cast<size_t>(indexOf(id))); }
  // Without base and bounds.
  LoopGate grown(const Uncertainty& u) const;
  LoopGate bounded(const LoopGate& gate) const;

  LoopGateConfig config_;
  std::vector<Node> nodes_;
};

}  // namespace sgraphs
