#include <array>
#include <cstring>

#include "backend/graph/situational_graph.h"
#include "common/base/sha256.h"

namespace sgraphs {
namespace {

// Collects the canonical bytes of the snapshot and hashes them in blocks: a graph of 5000 keyframes has
// half a million numbers, and the digest is taken every round.
class CanonicalBytes {
 public:
  void add(int64_t value) { append(&value, sizeof value); }
  void add(double value) { append(&value, sizeof value); }
  void add(const SE3& T) {
    add(T.translation);
    add(T.rotation.coeffs());
  }
  template <typename Derived>
  void add(const Eigen::DenseBase<Derived>& values) {
    for (Eigen::Index r = 0; r < values.rows(); ++r)
      for (Eigen::Index c = 0; c < values.cols(); ++c) add(values(r, c));
  }
  std::string hex() {
    flush();
    return sha_.hex();
  }

 private:
  void append(const void* data, size_t size) {
    if (used_ + size > buffer_.size()) flush();
    std::memcpy(buffer_.data() + used_, data, size);
    used_ += size;
  }
  void flush() {
    sha_.addBytes({buffer_.data(), used_});
    used_ = 0;
  }

  Sha256 sha_;
  std::array<uint8_t, 1 << 14> buffer_{};
  size_t used_ = 0;
};

void addCovariance(const Matrix6d& covariance, CanonicalBytes& bytes) {
  for (int r = 0; r < 6; ++r)
    for (int c = r; c < 6; ++c) bytes.add(covariance(r, c));
}

template <typename Factor>
void addPlanePairs(const std::vector<Factor>& factors, double Factor::*sigma, CanonicalBytes& bytes) {
  bytes.add(static_cast<int64_t>(factors.size()));
  for (const Factor& factor : factors) {
    bytes.add(factor.id);
    bytes.add(factor.a.value);
    bytes.add(factor.b.value);
    bytes.add(factor.*sigma);
  }
}

void addPlanes(const SituationalGraph& graph, CanonicalBytes& bytes) {
  bytes.add(static_cast<int64_t>(graph.planes.size()));
  for (const auto& [id, plane] : graph.planes) {
    bytes.add(id.value);
    bytes.add(static_cast<int64_t>(plane.label));
    bytes.add(plane.floor.value);
    bytes.add(plane.normal_map);
    bytes.add(plane.anchor_map);
    bytes.add(plane.offset_m);
    bytes.add(plane.covariance);
    bytes.add(plane.centroid_map);
    bytes.add(static_cast<int64_t>(plane.polygon_map.size()));
    for (const Eigen::Vector3d& corner : plane.polygon_map) bytes.add(corner);
    bytes.add(plane.num_observations);
  }
  for (const auto& [from, to] : graph.merged_planes) {
    bytes.add(from.value);
    bytes.add(to.value);
  }
}

void addRooms(const SituationalGraph& graph, CanonicalBytes& bytes) {
  bytes.add(static_cast<int64_t>(graph.rooms.size()));
  for (const auto& [id, room] : graph.rooms) {
    bytes.add(id.value);
    bytes.add(room.center_map);
    bytes.add(static_cast<int64_t>(room.seen.kind));
    bytes.add(room.seen.floor.value);
    bytes.add(room.seen.accepted.us);
    bytes.add(room.seen.area_m2);
    bytes.add(static_cast<int64_t>(room.seen.polygon.size()));
    for (const RoomCorner& corner : room.seen.polygon) {
      bytes.add(corner.position_map);
      bytes.add(corner.wall.value);
    }
    bytes.add(static_cast<int64_t>(room.seen.pairs.size()));
    for (const auto& [a, b] : room.seen.pairs) {
      bytes.add(a.value);
      bytes.add(b.value);
    }
  }
  bytes.add(static_cast<int64_t>(graph.doorways.size()));
  for (const auto& [id, doorway] : graph.doorways) {
    bytes.add(id.value);
    bytes.add(doorway.floor.value);
    bytes.add(doorway.a.value);
    bytes.add(doorway.b.value);
    bytes.add(doorway.position_map);
    bytes.add(doorway.width_m);
  }
  bytes.add(static_cast<int64_t>(graph.floors.size()));
  for (const auto& [id, floor] : graph.floors) {
    bytes.add(id.value);
    bytes.add(floor.center_map);
    bytes.add(static_cast<int64_t>(floor.has_height));
    bytes.add(floor.z_m);
  }
}

void addRoomFactors(const SituationalGraph& graph, CanonicalBytes& bytes) {
  bytes.add(static_cast<int64_t>(graph.center_walls.size()));
  for (const CenterWallsFactor& factor : graph.center_walls) {
    for (const int64_t id :
         {factor.id, factor.of.room.value, factor.of.floor.value, factor.a.value, factor.b.value})
      bytes.add(id);
    bytes.add(static_cast<int64_t>(factor.finite));
    bytes.add(factor.height_m);
    bytes.add(factor.sigma_m);
  }
  bytes.add(static_cast<int64_t>(graph.center_anchors.size()));
  for (const CenterAnchorFactor& factor : graph.center_anchors) {
    for (const int64_t id : {factor.id, factor.of.room.value, factor.of.floor.value, factor.keyframe.value})
      bytes.add(id);
    bytes.add(factor.center_body);
    bytes.add(factor.along_body);
    bytes.add(factor.sigma_m);
  }
  bytes.add(static_cast<int64_t>(graph.room_shapes.size()));
  for (const RoomShapeFactor& factor : graph.room_shapes) {
    for (const int64_t id : {factor.id, factor.room.value, factor.a.value, factor.b.value}) bytes.add(id);
    bytes.add(static_cast<int64_t>(factor.square));
    bytes.add(factor.sigma_rad);
  }
  bytes.add(static_cast<int64_t>(graph.floor_heights.size()));
  for (const FloorHeightFactor& factor : graph.floor_heights) {
    for (const int64_t id : {factor.id, factor.floor.value, factor.plane.value}) bytes.add(id);
    bytes.add(factor.sigma_m);
  }
  bytes.add(static_cast<int64_t>(graph.floor_rooms.size()));
  for (const FloorRoomFactor& factor : graph.floor_rooms) {
    for (const int64_t id : {factor.id, factor.floor.value, factor.room.value}) bytes.add(id);
    bytes.add(factor.offset_map);
    bytes.add(factor.sigma_m);
  }
}

// Those switched off, too: they may come back.
void addLoops(const SituationalGraph& graph, CanonicalBytes& bytes) {
  bytes.add(static_cast<int64_t>(graph.loops.size()));
  for (const auto& [id, loop] : graph.loops) {
    bytes.add(id.value);
    bytes.add(loop.factor);
    bytes.add(loop.measurement.from.value);
    bytes.add(loop.measurement.to.value);
    bytes.add(loop.measurement.T_from_to);
    addCovariance(loop.measurement.covariance, bytes);
  }
}

void addFactors(const SituationalGraph& graph, CanonicalBytes& bytes) {
  // Kinds in the order of their enumeration, within a kind in the order of their ids (they are monotonic).
  for (const RelativePoseKind kind :
       {RelativePoseKind::kOdometry, RelativePoseKind::kNeighbour, RelativePoseKind::kLoop}) {
    bytes.add(static_cast<int64_t>(kind));
    for (const RelativePoseFactor& factor : graph.relative_poses) {
      const RelativePose& z = factor.measurement;
      if (z.kind != kind) continue;
      bytes.add(factor.id);
      bytes.add(z.from.value);
      bytes.add(z.to.value);
      bytes.add(z.T_from_to);
      addCovariance(z.covariance, bytes);
    }
  }
  bytes.add(static_cast<int64_t>(graph.observations.size()));
  for (const ObservationFactor& factor : graph.observations) {
    bytes.add(factor.id);
    bytes.add(factor.keyframe.value);
    bytes.add(factor.plane.value);
    bytes.add(factor.measurement.normal_body);
    bytes.add(factor.measurement.centroid_body);
    bytes.add(factor.measurement.covariance);
  }
  bytes.add(static_cast<int64_t>(graph.plane_ups.size()));
  for (const PlaneUpFactor& factor : graph.plane_ups) {
    bytes.add(factor.id);
    bytes.add(factor.plane.value);
    bytes.add(static_cast<int64_t>(factor.level));
    bytes.add(factor.sigma_rad);
  }
  addPlanePairs(graph.faces, &FacesFactor::sigma_rad, bytes);
  addPlanePairs(graph.same_heights, &SameHeightFactor::sigma_m, bytes);
  bytes.add(static_cast<int64_t>(graph.ups.size()));
  for (const UpFactor& factor : graph.ups) {
    bytes.add(factor.id);
    bytes.add(factor.keyframe.value);
    bytes.add(factor.up_body);
    bytes.add(factor.sigma_rad);
  }
}

}  // namespace

std::string SituationalGraph::digest() const {
  CanonicalBytes bytes;
  bytes.add(static_cast<int64_t>(keyframes.size()));
  for (const auto& [id, node] : keyframes) {
    bytes.add(id.value);
    bytes.add(node.time.us);
    bytes.add(node.T_map_body);
    bytes.add(node.T_odom_body);
    bytes.add(node.floor.value);
  }
  addPlanes(*this, bytes);
  addRooms(*this, bytes);
  bytes.add(up_map);
  bytes.add(static_cast<int64_t>(relative_poses.size()));
  addLoops(*this, bytes);
  addFactors(*this, bytes);
  addRoomFactors(*this, bytes);
  return bytes.hex();
}

}  // namespace sgraphs
