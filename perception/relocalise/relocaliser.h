#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/types/keyframe.h"
#include "perception/loops/loops_config.h"
#include "perception/relocalise/relocalise_config.h"

namespace sgraphs {

// A keyframe of the map that the robot is sought in; its cloud is read once.
struct MapView {
  const Keyframe* keyframe = nullptr;
  SE3 T_map_body;
  FloorId floor;  // invalid: between storeys
};

// Where a new session begins in the map.
struct Relocalisation {
  KeyframeId anchor;   // of the map, beside the look that measured best
  KeyframeId matched;  // of the new session: that look
  KeyframeId first;    // the new session's first keyframe
  SE3 T_map_odom;      // odom of the new session
  SE3 T_anchor_first;
  // Of that: the registration of the look, and the odometry from the first keyframe to it.
  Matrix6d covariance = Matrix6d::Identity();
  double walked_m = 0;  // until the robot was found
  int looks = 0;        // that prove it
};

// Finds out where in a known map the robot is, without being told anything: at every metre the walls around
// are laid over those of the map, at all places that the robot was at and at all headings; what fits is
// registered and compared along both sides' rays as loops are. Every pose that any look proves stays a
// candidate until a later look refutes it. The robot is found when several looks, some metres apart by
// odometry, prove one candidate, and no other has nearly as many: in a building of rooms that look alike it
// waits until the way through them has told which one it was. A pure function of its inputs so far; its work
// per look and its memory are bounded.
class Relocaliser {
 public:
  Relocaliser(const RelocaliseConfig& config, const LoopsConfig& loops, const std::vector<MapView>& map);
  ~Relocaliser();

  // The new session's keyframes, in order of ids; nothing until the robot is found.
  std::optional<Relocalisation> step(const Keyframe& keyframe);

  double walked_m() const;
  // The walk was too long to go on looking.
  bool lost() const;
  // "at k12 of the map, proven by 2 looks; 3 other places are possible"; what a reader should know of a robot
  // that is lost.
  std::string describe() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgraphs
