#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "backend/backend.h"
#include "tests/backend/planes/plane_world.h"

namespace sgraphs::testing_support {

// A room of the world: corners counter-clockwise along the inner faces of its walls.
struct WorldRoom {
  Polygon2d corners;
  int64_t floor = 0;
  double z_m = 0;  // of its floor
};

WorldRoom boxRoom(double x, double y, double width, double depth, int64_t floor = 0, double z_m = 0);

// So many keyframes inside a room.
struct Visit {
  size_t room = 0;
  int keyframes = 6;
};

struct RoomWorldOptions {
  double start_heading_rad = 0;
  bool noise = false;  // of odometry and planes, as their covariances say
  double drift_m = 0;  // on the way to each room, along each axis of the body
  double odometry_sigma_m = 0.01;
  uint32_t seed = 1;
};

// Keyframes that see all walls and the floor of the room they are in.
struct RoomWorld {
  std::vector<WorldRoom> rooms;
  std::vector<SE3> truth;       // T_world_body
  std::vector<size_t> room_of;  // by keyframe
  std::vector<Keyframe> keyframes;
  std::vector<KeyframePlanes> planes;
};

RoomWorld makeRoomWorld(std::vector<WorldRoom> rooms, const std::vector<Visit>& visits,
                        const RoomWorldOptions& options = {});

// A room as it is seen in the graph: its walls are the planes nearest to where they would be, by the estimate
// of the keyframe `anchor`. Pairs are edges 0 and 2, and 1 and 3, as far as the kind has them.
RoomObservation seenRoom(const RoomWorld& world, size_t room, const SituationalGraph& graph, RoomId id,
                         RoomKind kind, KeyframeId anchor);

// All rooms that were visited so far, finite if they have four walls, each by the first keyframe in it, and
// the storeys of all keyframes.
Rooms seenRooms(const RoomWorld& world, const SituationalGraph& graph, int64_t round);

// A backend fed with a world round by round; each round has the rooms as `rooms` makes them of the map so
// far.
struct RoomRun {
  Backend backend;
  int64_t round = 0;
  RoundOutput newest;

  explicit RoomRun(const BackendConfig& config = {}) : backend(config) {}
  const SituationalGraph& graph() const { return backend.graph(); }
  int64_t count(const char* kind) const { return backend.factorStatistics().at(kind).count; }

  void step(const RoomWorld& world, size_t keyframe, std::optional<Rooms> rooms = {});
  void idle(std::optional<Rooms> rooms = {});
  // All keyframes, then idle rounds.
  void all(const RoomWorld& world, bool with_rooms);
};

}  // namespace sgraphs::testing_support
