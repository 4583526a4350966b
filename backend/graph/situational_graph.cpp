#include "backend/graph/situational_graph.h"

#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

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

}  // namespace

const char* toString(PlaneLabel label) {
  if (label == PlaneLabel::kX) return "x";
  return label == PlaneLabel::kY ? "y" : "horizontal";
}

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
  bytes.add(static_cast<int64_t>(floors.size()));
  for (const auto& [id, floor] : floors) {
    bytes.add(id.value);
    bytes.add(floor.center_map);
    bytes.add(static_cast<int64_t>(floor.has_height));
    bytes.add(floor.z_m);
  }
  bytes.add(up_map);
  bytes.add(static_cast<int64_t>(relative_poses.size()));
  addFactors(*this, bytes);
  return bytes.hex();
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
  for (const UpFactor& factor : ups) {
    checkKeyframe(factor.keyframe, factor.id);
    if (!factor.up_body.allFinite() || !(factor.sigma_rad > 0))
      broken("factor " + std::to_string(factor.id) + " is not finite");
  }
  checkPlaneFactors(*this);
}

}  // namespace sgraphs
