#pragma once

#include <optional>
#include <vector>

#include "tools/eval/truth.h"

namespace sgraphs {

// How long the body was in a room.
struct RoomVisit {
  double inside_s = 0;
  std::optional<Time> entered;  // when the first second without a break inside began

  // Rooms entered for so long in all are asked for (contract.md).
  static constexpr double kAskedAfter_s = 1.0;
};

// As Plan::rooms. The body is on a storey from 0.2 m below to 1.6 m above its floor.
std::vector<RoomVisit> roomVisits(const Plan& plan, const std::vector<StampedPose>& poses);

// As Plan::rooms: entered, and no corridor.
std::vector<bool> askedRooms(const Plan& plan, const std::vector<RoomVisit>& visits);

// The storey that a body at this height is on; none between storeys, on stairs.
std::optional<size_t> storeyAt(const Plan& plan, double body_z_m);

// As Plan::floors_z_m: seconds of the path on each.
std::vector<double> secondsOnStoreys(const Plan& plan, const std::vector<StampedPose>& poses);

// Ends of a doorway's threshold. It lies along the wall that the doorway is cut out of; none if the plan has
// no such wall.
std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>> thresholdOf(const Plan& plan,
                                                                       const TrueDoorway& doorway);

// As Plan::doorways: the path crosses the threshold, or comes within half its width where no wall tells how
// it lies.
std::vector<bool> walkedThrough(const Plan& plan, const std::vector<StampedPose>& poses);

}  // namespace sgraphs
