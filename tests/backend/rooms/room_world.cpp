#include "tests/backend/rooms/room_world.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sgraphs::testing_support {
namespace {

constexpr double kHeight_m = 2.6, kBody_m = 0.6, kReach_m = 5;

std::vector<Face> facesOf(const WorldRoom& room) {
  std::vector<Face> faces;
  Eigen::Vector2d low = room.corners[0], high = room.corners[0];
  for (size_t i = 0; i < room.corners.size(); ++i) {
    const Eigen::Vector2d a = room.corners[i], b = room.corners[(i + 1) % room.corners.size()];
    const Eigen::Vector2d along = (b - a).normalized(), mid = 0.5 * (a + b);
    faces.push_back({{mid.x(), mid.y(), room.z_m + kHeight_m / 2},
                     {-along.y(), along.x(), 0},
                     0.5 * (b - a).norm(),
                     kHeight_m / 2});
    low = low.cwiseMin(a);
    high = high.cwiseMax(a);
  }
  const Eigen::Vector2d mid = 0.5 * (low + high), half = 0.5 * (high - low);
  // Its own axis of width is world y.
  faces.push_back({{mid.x(), mid.y(), room.z_m}, {0, 0, 1}, half.y(), half.x()});
  return faces;
}

PlaneId nearestPlane(const SituationalGraph& graph, const Eigen::Vector3d& normal_map,
                     const Eigen::Vector3d& centre_map) {
  PlaneId best;
  double least = 0.15;
  for (const auto& [id, plane] : graph.planes) {
    const double distance = std::abs(plane.distance(centre_map));
    if (plane.normal_map.dot(normal_map) < 0.98 || distance > least) continue;
    if ((plane.centroid_map - centre_map).norm() > kReach_m) continue;
    least = distance;
    best = id;
  }
  return best;
}

}  // namespace

WorldRoom boxRoom(double x, double y, double width, double depth, int64_t floor, double z_m) {
  return {{{x, y}, {x + width, y}, {x + width, y + depth}, {x, y + depth}}, floor, z_m};
}

RoomWorld makeRoomWorld(std::vector<WorldRoom> rooms, const std::vector<Visit>& visits,
                        const RoomWorldOptions& options) {
  RoomWorld world;
  world.rooms = std::move(rooms);
  std::mt19937 random(options.seed);
  std::normal_distribution<double> normal;
  const SE3 turn(so3Exp({0, 0, options.start_heading_rad}), Eigen::Vector3d::Zero());
  SE3 T_odom_body;
  for (const Visit& visit : visits) {
    const WorldRoom& room = world.rooms[visit.room];
    const Eigen::Vector2d mid = polygonCentroid(room.corners);
    for (int i = 0; i < visit.keyframes; ++i) {
      const double s = 1.4 * i / std::max(1, visit.keyframes - 1) - 0.7;
      const size_t k = world.truth.size();
      world.truth.push_back(
          SE3(so3Exp({0, 0, 0.4 * s}), {mid.x() + s, mid.y() + 0.4 * s, room.z_m + kBody_m}) * turn);
      world.room_of.push_back(visit.room);
      Keyframe keyframe;
      keyframe.id = KeyframeId{static_cast<int64_t>(k)};
      keyframe.time = Time{1'000'000 * (static_cast<int64_t>(k) + 1)};
      if (k > 0) {
        RelativePose z;
        z.from = KeyframeId{keyframe.id.value - 1};
        z.to = keyframe.id;
        Vector6d sigma;
        sigma << Eigen::Vector3d::Constant(options.odometry_sigma_m), Eigen::Vector3d::Constant(0.001);
        z.covariance = sigma.cwiseAbs2().asDiagonal();
        Vector6d error = Vector6d::Zero();
        for (int j = 0; options.noise && j < 6; ++j) error(j) = sigma(j) * normal(random);
        if (i == 0) error.head<2>().array() += options.drift_m;
        z.T_from_to = world.truth[k - 1].inverse() * world.truth[k] * se3Exp(error);
        keyframe.relative_poses.push_back(z);
        T_odom_body = T_odom_body * z.T_from_to;
      }
      keyframe.T_odom_body = T_odom_body;
      KeyframePlanes planes{.keyframe = keyframe.id, .time = keyframe.time, .planes = {}};
      for (const Face& face : facesOf(room)) {
        const PlaneObservation z = observe(face, world.truth[k]);
        planes.planes.push_back(options.noise ? noisy(z, random) : z);
      }
      world.keyframes.push_back(std::move(keyframe));
      world.planes.push_back(std::move(planes));
    }
  }
  return world;
}

RoomObservation seenRoom(const RoomWorld& world, size_t room, const SituationalGraph& graph, RoomId id,
                         RoomKind kind, KeyframeId anchor) {
  const WorldRoom& truth = world.rooms[room];
  const SE3 T_map_world =
      graph.keyframes.at(anchor).T_map_body * world.truth[static_cast<size_t>(anchor.value)].inverse();
  const auto inMap = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    return (T_map_world * Eigen::Vector3d(p.x(), p.y(), truth.z_m)).head<2>();
  };
  RoomObservation seen;
  seen.id = id;
  seen.kind = kind;
  seen.floor = FloorId{truth.floor};
  seen.accepted = graph.keyframes.at(anchor).time;
  seen.anchor = anchor;
  seen.area_m2 = polygonArea(truth.corners);
  seen.center_map = seen.free_center_map = inMap(polygonCentroid(truth.corners));
  const std::vector<Face> faces = facesOf(truth);
  std::vector<PlaneId> walls;
  for (size_t i = 0; i < truth.corners.size(); ++i) {
    walls.push_back(
        nearestPlane(graph, T_map_world.rotation * faces[i].normal, T_map_world * faces[i].centre));
    seen.polygon.push_back({inMap(truth.corners[i]), walls.back()});
  }
  if (kind != RoomKind::kPolygon) seen.pairs.emplace_back(walls[0], walls[2]);
  if (kind == RoomKind::kFinite) seen.pairs.emplace_back(walls[1], walls[3]);
  return seen;
}

Rooms seenRooms(const RoomWorld& world, const SituationalGraph& graph, int64_t round) {
  Rooms rooms;
  rooms.round = round;
  std::map<int64_t, double> floors;
  for (const auto& [id, node] : graph.keyframes) {
    const WorldRoom& room = world.rooms[world.room_of[static_cast<size_t>(id.value)]];
    floors[room.floor] = room.z_m - kBody_m;
    if (node.floor != FloorId{room.floor}) rooms.keyframe_floors.push_back({id, FloorId{room.floor}});
  }
  for (const auto& [floor, z] : floors)
    rooms.floors.push_back({.id = FloorId{floor}, .has_height = true, .z_m = z});
  for (size_t r = 0; r < world.rooms.size(); ++r) {
    const auto first = std::find(world.room_of.begin(), world.room_of.end(), r);
    const KeyframeId anchor{first - world.room_of.begin()};
    if (!graph.keyframes.contains(KeyframeId{anchor.value + 1})) continue;
    const bool finite = world.rooms[r].corners.size() == 4;
    rooms.rooms.push_back(seenRoom(world, r, graph, RoomId{static_cast<int64_t>(r)},
                                   finite ? RoomKind::kFinite : RoomKind::kPolygon, anchor));
  }
  return rooms;
}

void RoomRun::step(const RoomWorld& world, size_t keyframe, std::optional<Rooms> rooms) {
  newest = backend.step({.round = round++,
                         .time = world.keyframes[keyframe].time,
                         .keyframe = world.keyframes[keyframe],
                         .planes = world.planes[keyframe],
                         .rooms = std::move(rooms)});
}

void RoomRun::idle(std::optional<Rooms> rooms) {
  newest = backend.step({.round = round++, .time = Time{}, .keyframe = {}, .rooms = std::move(rooms)});
}

void RoomRun::all(const RoomWorld& world, bool with_rooms) {
  const auto rooms = [&]() -> std::optional<Rooms> {
    if (!with_rooms || round == 0) return std::nullopt;
    return seenRooms(world, graph(), round - 1);
  };
  for (size_t k = 0; k < world.keyframes.size(); ++k) step(world, k, rooms());
  for (int i = 0; i < 3; ++i) idle(rooms());
  graph().check();
}

}  // namespace sgraphs::testing_support
