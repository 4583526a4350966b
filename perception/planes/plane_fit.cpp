#include "perception/planes/plane_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/tangent_basis.h"

namespace sgraphs {
namespace {

constexpr int kIterations = 4;
// A fit needs some more points than unknowns.
constexpr double kMinFreedom = 10;

// In proportion to the raw points. Where a wall lies along the voxel grid, its points are shared out between
// two layers of voxels; any weight that favours the thinner layer moves the wall by millimetres.
double weightOf(const ViewedPoint& point, const Eigen::Vector3d& normal, const PlaneNoiseConfig& noise) {
  const double along_normal = noise.range_sigma_m * normal.dot(point.to_viewpoint);
  return point.count / (along_normal * along_normal + noise.surface_sigma_m * noise.surface_sigma_m + 1e-8);
}

double biweight(double residual, double width) {
  const double x = residual / width;
  return std::abs(x) >= 1 ? 0 : (1 - x * x) * (1 - x * x);
}

// Of the keyframe's own pose in the cloud that its scans were put together to: translation t and rotation r
// of the cloud turn the normal by r x n and move the plane at the centroid c by n.t + (c x n).r.
Eigen::Matrix3d floorOf(const PlaneFit& fit, const TangentBasis& axes, const PlaneNoiseConfig& noise) {
  const Eigen::Vector3d& n = fit.plane.normal;
  Eigen::Matrix<double, 3, 6> J;
  J.row(0) << 0, 0, 0, n.cross(axes.col(0)).transpose();
  J.row(1) << 0, 0, 0, n.cross(axes.col(1)).transpose();
  J.row(2) << n.transpose(), fit.centroid.cross(n).transpose();
  // An exact cloud without floors still is no perfect knowledge: the covariance stays regular.
  return J * noise.poseSigma().cwiseAbs2().asDiagonal() * J.transpose() + 1e-12 * Eigen::Matrix3d::Identity();
}

// Normal equations of (tilt_u, tilt_v, offset) at the centroid: a point's distance from the true plane is
// residual + a tilt_u + b tilt_v - offset, with (a, b) the point's place along (u, v). Beside them each
// scan's own gradient: where the points of a scan err together, it does not average out within the scan.
void addCovariance(const std::vector<ViewedPoint>& points, std::span<const int32_t> members,
                   double distance_m, const PlaneNoiseConfig& noise, PlaneFit& fit) {
  const TangentBasis axes = tangentBasis(fit.plane.normal);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  std::array<Eigen::Vector3d, 256> gradient_of_scan;
  gradient_of_scan.fill(Eigen::Vector3d::Zero());
  double chi2 = 0, freedom = 0, squares = 0;
  for (const int32_t i : members) {
    const ViewedPoint& point = points[static_cast<size_t>(i)];
    const double residual = fit.plane.distance(point.position);
    const double robust = biweight(residual, distance_m);
    if (robust == 0) continue;
    const double weight = robust * weightOf(point, fit.plane.normal, noise);
    Eigen::Vector3d J;
    J << axes.transpose() * (point.position - fit.centroid), -1.0;
    information += (weight * J) * J.transpose();
    gradient_of_scan[point.scan] += (weight * residual) * J;
    chi2 += weight * residual * residual;
    squares += robust * residual * residual;
    freedom += robust;
  }
  const Eigen::LLT<Eigen::Matrix3d> llt(information);
  if (freedom < kMinFreedom || llt.info() != Eigen::Success) return;
  Eigen::Matrix3d scatter = noise.scale * chi2 / (freedom - 3) * information;
  for (const Eigen::Vector3d& gradient : gradient_of_scan) scatter += gradient * gradient.transpose();
  const Eigen::Matrix3d inverse = llt.solve(Eigen::Matrix3d::Identity());
  fit.covariance = inverse * scatter * inverse + floorOf(fit, axes, noise);
  fit.covariance = (0.5 * (fit.covariance + fit.covariance.transpose())).eval();
  fit.rms_m = std::sqrt(squares / freedom);
  fit.valid = fit.covariance.allFinite();
}

}  // namespace

PlaneFit fitPlane(const std::vector<ViewedPoint>& points, std::span<const int32_t> members,
                  const Hypothesis& start, double distance_m, const PlaneNoiseConfig& noise) {
  PlaneFit fit;
  fit.plane = start;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    PlaneMoments moments;
    for (const int32_t i : members) {
      const ViewedPoint& point = points[static_cast<size_t>(i)];
      const double robust = biweight(fit.plane.distance(point.position), distance_m);
      if (robust > 0) moments.add(point.position, robust * weightOf(point, fit.plane.normal, noise));
    }
    if (!(moments.weight > 0)) return fit;
    fit.centroid = moments.mean();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moments.covariance());
    Eigen::Vector3d normal = eigen.eigenvectors().col(0).normalized();
    if (normal.dot(fit.plane.normal) < 0) normal = -normal;
    fit.plane = {normal, -normal.dot(fit.centroid)};
  }
  addCovariance(points, members, distance_m, noise, fit);
  return fit;
}

}  // namespace sgraphs
