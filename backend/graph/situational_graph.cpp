#include "backend/graph/situational_graph.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sgraphs {
namespace {

[[noreturn]] void broken(const std::string& what) {
  throw std::logic_error("situational graph: " + what);
}

void checkNodes(const SituationalGraph& graph) {
  for (const auto& [id, node] : graph.keyframes) {
    if (!id.valid() || node.id != id) broken("keyframe " + id.str() + " is filed under another id");
    if (!node.T_map_body.isFinite() || !node.T_odom_body.isFinite())
      broken("keyframe " + id.str() + " has a pose that is not finite");
    if (node.floor.valid() && !graph.floors.contains(node.floor))
      broken("keyframe " + id.str() + " is on " + node.floor.str() + ", which does not exist");
  }
  for (const auto& [id, plane] : graph.planes) {
    if (!id.valid() || plane.id != id) broken("plane " + id.str() + " is filed under another id");
    if (!(std::abs(plane.normal_map.norm() - 1.0) < 1e-6) || !plane.anchor_map.allFinite() ||
        !std::isfinite(plane.offset_m) || !plane.centroid_map.allFinite())
      broken("plane " + id.str() + " is not finite or its normal no unit vector");
    if (plane.floor.valid() && !graph.floors.contains(plane.floor))
      broken("plane " + id.str() + " is on " + plane.floor.str() + ", which does not exist");
  }
  for (const auto& [id, floor] : graph.floors) {
    if (!id.valid() || floor.id != id) broken("floor " + id.str() + " is filed under another id");
    if (!floor.center_map.allFinite() || !std::isfinite(floor.z_m))
      broken("floor " + id.str() + " is not finite");
  }
  for (const auto& [id, room] : graph.rooms) {
    if (!id.valid() || room.seen.id != id) broken("room " + id.str() + " is filed under another id");
    if (!room.center_map.allFinite()) broken("room " + id.str() + " is not finite");
    if (!graph.floors.contains(room.seen.floor))
      broken("room " + id.str() + " is on " + room.seen.floor.str() + ", which does not exist");
    for (const PlaneId wall : room.seen.walls())
      if (!graph.planes.contains(wall))
        broken("room " + id.str() + " has wall " + wall.str() + ", which does not exist");
  }
  for (const auto& [id, doorway] : graph.doorways) {
    if (!id.valid() || doorway.id != id) broken("doorway " + id.str() + " is filed under another id");
    for (const RoomId room : {doorway.a, doorway.b})
      if (room.valid() && !graph.rooms.contains(room))
        broken("doorway " + id.str() + " leads to " + room.str() + ", which does not exist");
  }
  if (!(std::abs(graph.up_map.norm() - 1.0) < 1e-6)) broken("up is not a unit vector");
}

void checkPlaneFactors(const SituationalGraph& graph) {
  const auto checkPlane = [&](PlaneId id, int64_t factor) {
    if (!graph.planes.contains(id))
      broken("factor " + std::to_string(factor) + " names plane " + id.str() + ", which does not exist");
  };
  for (const ObservationFactor& factor : graph.observations) {
    checkPlane(factor.plane, factor.id);
    if (!graph.keyframes.contains(factor.keyframe))
      broken("factor " + std::to_string(factor.id) + " names keyframe " + factor.keyframe.str() +
             ", which does not exist");
  }
  for (const PlaneUpFactor& factor : graph.plane_ups) checkPlane(factor.plane, factor.id);
  for (const auto& factor : graph.faces) {
    checkPlane(factor.a, factor.id);
    checkPlane(factor.b, factor.id);
  }
  for (const auto& factor : graph.same_heights) {
    checkPlane(factor.a, factor.id);
    checkPlane(factor.b, factor.id);
  }
}

void checkRoomFactors(const SituationalGraph& graph) {
  const auto need = [](bool there, int64_t factor, const char* what) {
    if (!there) broken("factor " + std::to_string(factor) + " names a " + what + " that does not exist");
  };
  const auto needCenter = [&](const CenterOf& of, int64_t factor) {
    need(of.room.valid() != of.floor.valid(), factor, "centre");
    need(!of.room.valid() || graph.rooms.contains(of.room), factor, "room");
    need(!of.floor.valid() || graph.floors.contains(of.floor), factor, "floor");
  };
  for (const CenterWallsFactor& f : graph.center_walls) {
    needCenter(f.of, f.id);
    need(f.a != f.b && graph.planes.contains(f.a) && graph.planes.contains(f.b), f.id, "pair of planes");
  }
  for (const CenterAnchorFactor& f : graph.center_anchors) {
    needCenter(f.of, f.id);
    need(graph.keyframes.contains(f.keyframe), f.id, "keyframe");
  }
  for (const RoomShapeFactor& f : graph.room_shapes) {
    need(graph.rooms.contains(f.room), f.id, "room");
    need(f.a != f.b && graph.planes.contains(f.a) && graph.planes.contains(f.b), f.id, "pair of planes");
  }
  for (const FloorHeightFactor& f : graph.floor_heights) {
    need(graph.floors.contains(f.floor), f.id, "floor");
    need(graph.planes.contains(f.plane), f.id, "plane");
  }
  for (const FloorRoomFactor& f : graph.floor_rooms) {
    need(graph.floors.contains(f.floor), f.id, "floor");
    need(graph.rooms.contains(f.room), f.id, "room");
  }
}

}  // namespace

const char* toString(PlaneLabel label) {
  if (label == PlaneLabel::kX) return "x";
  return label == PlaneLabel::kY ? "y" : "horizontal";
}

void SituationalGraph::check() const {
  checkNodes(*this);
  const auto checkKeyframe = [&](KeyframeId id, int64_t factor) {
    if (!keyframes.contains(id))
      broken("factor " + std::to_string(factor) + " names keyframe " + id.str() + ", which does not exist");
  };
  for (const RelativePoseFactor& factor : relative_poses) {
    checkKeyframe(factor.measurement.from, factor.id);
    checkKeyframe(factor.measurement.to, factor.id);
    if (!factor.measurement.T_from_to.isFinite() || !factor.measurement.covariance.allFinite())
      broken("factor " + std::to_string(factor.id) + " is not finite");
  }
  for (const auto& [id, loop] : loops) {
    const auto isOf = [factor = loop.factor](const RelativePoseFactor& f) { return f.id == factor; };
    if (loop.active() && std::none_of(relative_poses.begin(), relative_poses.end(), isOf))
      broken("loop " + id.str() + " is active without a factor");
  }
  for (const UpFactor& factor : ups) {
    checkKeyframe(factor.keyframe, factor.id);
    if (!factor.up_body.allFinite() || !(factor.sigma_rad > 0))
      broken("factor " + std::to_string(factor.id) + " is not finite");
  }
  checkPlaneFactors(*this);
  checkRoomFactors(*this);
}

}  // namespace sgraphs
