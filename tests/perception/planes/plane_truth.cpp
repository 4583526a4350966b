#include "tests/perception/planes/plane_truth.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/geometry/tangent_basis.h"

namespace sgraphs::testing_support {
namespace {

constexpr double kMaxDistance_m = 0.1;
constexpr double kMinCos = 0.94;

// Distance in the triangle's plane from a point's foot to the triangle.
double distanceBeside(const Eigen::Vector3d (&corner)[3], const Eigen::Vector3d& normal,
                      const Eigen::Vector3d& p) {
  double outside = 0, nearest = 1e9;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d& a = corner[i];
    const Eigen::Vector3d edge = corner[(i + 1) % 3] - a;
    const Eigen::Vector3d foot = p - normal * normal.dot(p - a);
    outside = std::max(outside, -normal.dot(edge.cross(foot - a)));
    const double s = std::clamp((foot - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (foot - a - s * edge).norm());
  }
  return outside > 0 ? nearest : 0;
}

}  // namespace

double PlaneError::tiltNees(const PlaneObservation& plane) const {
  const Eigen::Matrix2d covariance = plane.covariance.topLeftCorner<2, 2>();
  return error.head<2>().dot(covariance.inverse() * error.head<2>());
}

double PlaneError::offsetNees(const PlaneObservation& plane) const {
  return error(2) * error(2) / plane.covariance(2, 2);
}

std::optional<PlaneError> errorOf(const PlaneObservation& plane, const SE3& T_building_body,
                                  const simulate::TriangleMesh& mesh) {
  const Eigen::Vector3d n = T_building_body.rotation * plane.normal_body;
  const Eigen::Vector3d c = T_building_body * plane.centroid_body;
  const TangentBasis uv = tangentBasis(plane.normal_body);
  std::optional<PlaneError> result;
  double best_m = kMaxDistance_m;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d corner[3] = {mesh.vertices[triangle[0]], mesh.vertices[triangle[1]],
                                       mesh.vertices[triangle[2]]};
    const Eigen::Vector3d m = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
    if (m.dot(n) < kMinCos) continue;
    const double height = m.dot(c - corner[0]);
    const double away = std::hypot(height, 0.1 * distanceBeside(corner, m, c));
    if (away >= best_m) continue;
    best_m = away;
    const Eigen::Vector3d m_body = T_building_body.rotation.conjugate() * m;
    // The true plane meets the observed normal's line through the centroid at -height / (m.n).
    result = PlaneError{{uv.col(0).dot(m_body), uv.col(1).dot(m_body), -height / m.dot(n)}, c, m};
  }
  return result;
}

}  // namespace sgraphs::testing_support
