#pragma once

#include <map>
#include <optional>
#include <vector>

#include "common/types/rooms.h"
#include "perception/rooms/room_shape.h"

namespace sgraphs {

// A cluster that makes a room in this round.
struct RoomCandidate {
  ClusterId cluster;
  FloorId floor;
  const RoomShape* shape = nullptr;
  bool entered = false;  // the robot was in it
};

// A room that was accepted.
struct TrackedRoom {
  RoomId id;
  ClusterId cluster;
  FloorId floor;
  Time accepted;
  RoomShape shape;
  int missed_rounds = 0;
  KeyframeId anchor;
};

// Rooms from round to round: accepted once they look alike for some rounds, recognised by overlap, withdrawn
// when they stay away. Ids are never reused.
class RoomTracker {
 public:
  explicit RoomTracker(const RoomsConfig& config) : config_(config) {}

  // Candidates ascending by cluster. `kept`: clusters whose room stays though nothing supports it now.
  void step(Time time, const std::vector<RoomCandidate>& candidates, const std::vector<ClusterId>& kept);

  std::map<RoomId, TrackedRoom>& rooms() { return rooms_; }
  const std::map<RoomId, TrackedRoom>& rooms() const { return rooms_; }
  // The room that a cluster is; invalid: none.
  RoomId roomOf(ClusterId cluster) const;

 private:
  struct Sight {
    std::vector<PlaneId> walls;
    double area_m2 = 0;
    int rounds = 0;
  };
  bool isStable(const RoomCandidate& candidate);
  std::map<RoomId, size_t> matches(const std::vector<RoomCandidate>& candidates) const;
  void dropOverlapped();

  RoomsConfig config_;
  std::map<RoomId, TrackedRoom> rooms_;
  std::map<ClusterId, Sight> sights_;  // of the last round
  int64_t next_id_ = 0;
};

}  // namespace sgraphs
