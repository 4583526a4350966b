#include <Eigen/Cholesky>
#include <cmath>
#include <stdexcept>

#include "lcmtypes/convert/convert.h"

namespace sgraphs {
namespace {

plane_t toMessage(const PlaneObservation& plane) {
  if (plane.boundary.size() > kMaxBoundaryCorners)
    throw std::logic_error("plane with more corners than a message holds");
  plane_t m{};
  for (int i = 0; i < 3; ++i) {
    m.normal[i] = plane.normal_body[i];
    m.centroid[i] = plane.centroid_body[i];
  }
  int k = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = r; c < 3; ++c) m.covariance[k++] = plane.covariance(r, c);
  m.num_points = plane.num_points;
  m.rms_m = static_cast<float>(plane.rms_m);
  m.area_m2 = static_cast<float>(plane.area_m2);
  for (const Eigen::Vector2f& corner : plane.boundary) m.boundary.push_back({corner.x(), corner.y()});
  m.num_corners = static_cast<int32_t>(m.boundary.size());
  return m;
}

std::optional<PlaneObservation> fromMessage(const plane_t& m) {
  PlaneObservation plane;
  plane.normal_body = Eigen::Vector3d(m.normal);
  plane.centroid_body = Eigen::Vector3d(m.centroid);
  int k = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = r; c < 3; ++c) plane.covariance(r, c) = plane.covariance(c, r) = m.covariance[k++];
  plane.num_points = m.num_points;
  plane.rms_m = m.rms_m;
  plane.area_m2 = m.area_m2;
  for (const auto& corner : m.boundary) plane.boundary.emplace_back(corner[0], corner[1]);

  const bool finite = plane.normal_body.allFinite() && plane.centroid_body.allFinite() &&
                      plane.covariance.allFinite() && std::isfinite(m.rms_m) && std::isfinite(m.area_m2);
  if (!finite || std::abs(plane.normal_body.norm() - 1.0) > 1e-6) return std::nullopt;
  if (m.num_points < 1 || m.rms_m < 0 || m.area_m2 < 0) return std::nullopt;
  if (m.num_corners < 3 || m.num_corners > kMaxBoundaryCorners) return std::nullopt;
  for (const Eigen::Vector2f& corner : plane.boundary)
    if (!corner.allFinite()) return std::nullopt;
  if (plane.covariance.llt().info() != Eigen::Success) return std::nullopt;
  return plane;
}

}  // namespace

keyframe_planes_t toMessage(const KeyframePlanes& planes) {
  if (planes.planes.size() > kMaxPlanesPerKeyframe)
    throw std::logic_error("keyframe with more planes than a message holds");
  keyframe_planes_t m{};
  m.header.utime = planes.time.us;
  m.keyframe = planes.keyframe.value;
  for (int i = 0; i < 6; ++i) m.pose_sigma[i] = planes.pose_sigma[i];
  m.num_planes = static_cast<int32_t>(planes.planes.size());
  for (const PlaneObservation& plane : planes.planes) m.planes.push_back(toMessage(plane));
  return m;
}

std::optional<KeyframePlanes> fromMessage(const keyframe_planes_t& m) {
  if (m.keyframe < 0 || m.num_planes < 0 || m.num_planes > kMaxPlanesPerKeyframe) return std::nullopt;
  KeyframePlanes planes;
  planes.keyframe = KeyframeId{m.keyframe};
  planes.time = Time{m.header.utime};
  planes.pose_sigma = Vector6d(m.pose_sigma);
  if (!planes.pose_sigma.allFinite() || (planes.pose_sigma.array() < 0).any()) return std::nullopt;
  for (const plane_t& plane : m.planes) {
    const std::optional<PlaneObservation> observation = fromMessage(plane);
    if (!observation) return std::nullopt;
    planes.planes.push_back(*observation);
  }
  return planes;
}

}  // namespace sgraphs
