#include "perception/planes/facets.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "perception/odometry/voxel_index.h"

namespace sgraphs {
namespace {

constexpr int kLevels = 4;  // of cell sizes
// Returns nearer than this to their viewpoint have no direction of view.
constexpr double kMinRange_m = 1e-3;

struct Cell {
  Eigen::Vector3i at;
  int level;
  PlaneMoments moments;
  std::vector<int32_t> points;
};

uint64_t keyOf(const Eigen::Vector3i& at, int level) {
  return VoxelIndex::pack(at.x(), at.y(), at.z(), static_cast<uint64_t>(level));
}

std::vector<ViewedPoint> viewedPoints(const Keyframe& keyframe) {
  std::vector<Eigen::Vector3d> viewpoints;
  viewpoints.reserve(keyframe.T_keyframe_body.size());
  for (const SE3& T : keyframe.T_keyframe_body) viewpoints.push_back(T * keyframe.T_body_lidar.translation);
  std::vector<ViewedPoint> points;
  points.reserve(keyframe.points.size());
  for (const KeyframePoint& p : keyframe.points) {
    if (p.scan >= viewpoints.size()) continue;
    ViewedPoint point;
    point.position = p.position_body.cast<double>();
    const Eigen::Vector3d ray = viewpoints[p.scan] - point.position;
    point.range_m = ray.norm();
    if (!(point.range_m > kMinRange_m) || !std::isfinite(point.range_m)) continue;
    point.to_viewpoint = ray / point.range_m;
    point.count = p.count;
    points.push_back(point);
  }
  return points;
}

class Grid {
 public:
  explicit Grid(const FacetConfig& config) : config_(config) { cells.reserve(4096); }

  double sizeOf(int level) const { return config_.cell_m * (1 << level); }

  void add(const ViewedPoint& point, int32_t index) {
    int level = 0;
    while (level + 1 < kLevels && point.range_m > config_.cell_range_m * (1 << level)) ++level;
    const Eigen::Vector3i at = (point.position / sizeOf(level)).array().floor().matrix().cast<int>();
    const uint64_t key = keyOf(at, level);
    int32_t i = index_.find(key);
    if (i < 0) {
      i = static_cast<int32_t>(cells.size());
      index_.insert(key, i);
      cells.push_back({at, level, {}, {}});
    }
    Cell& cell = cells[static_cast<size_t>(i)];
    cell.moments.add(point.position, 1.0);
    cell.points.push_back(index);
  }

  PlaneMoments around(const Cell& cell) const {
    PlaneMoments sum;
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz) {
          const int32_t i = index_.find(keyOf(cell.at + Eigen::Vector3i(dx, dy, dz), cell.level));
          if (i >= 0) sum.add(cells[static_cast<size_t>(i)].moments);
        }
    return sum;
  }

  std::vector<Cell> cells;

 private:
  FacetConfig config_;
  VoxelIndex index_;
};

// Normal without sign; nothing where the points are no surface, or too few to tell.
std::optional<Eigen::Vector3d> normalOf(const PlaneMoments& moments, const FacetConfig& config) {
  if (moments.weight < config.min_points) return std::nullopt;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(moments.covariance());
  const double thin = std::max(eigen.eigenvalues()(0), 0.0), wide = eigen.eigenvalues()(1);
  if (thin > config.max_thickness_m * config.max_thickness_m || thin >= 0.5 * wide) return std::nullopt;
  // Variance of an eigenvector (Anderson, "Asymptotic theory for principal component analysis", 1963).
  const double variance = thin * wide / (moments.weight * (wide - thin) * (wide - thin));
  if (variance > config.max_normal_sigma_rad * config.max_normal_sigma_rad) return std::nullopt;
  return eigen.eigenvectors().col(0).normalized();
}

}  // namespace

FacetCloud makeFacets(const Keyframe& keyframe, const FacetConfig& config) {
  FacetCloud cloud;
  cloud.points = viewedPoints(keyframe);
  Grid grid(config);
  for (size_t i = 0; i < cloud.points.size(); ++i) grid.add(cloud.points[i], static_cast<int32_t>(i));
  for (const Cell& cell : grid.cells) {
    const std::optional<Eigen::Vector3d> normal = normalOf(grid.around(cell), config);
    if (!normal) continue;
    int32_t facet_of_side[2] = {-1, -1};
    for (const int32_t i : cell.points) {
      ViewedPoint& point = cloud.points[static_cast<size_t>(i)];
      const bool back = normal->dot(point.to_viewpoint) < 0;
      int32_t& facet = facet_of_side[back];
      if (facet < 0) {
        facet = static_cast<int32_t>(cloud.facets.size());
        cloud.facets.emplace_back();
        cloud.facets.back().normal = back ? Eigen::Vector3d(-*normal) : *normal;
        cloud.facets.back().area_m2 = grid.sizeOf(cell.level) * grid.sizeOf(cell.level);
      }
      point.facet = facet;
      cloud.facets[static_cast<size_t>(facet)].moments.add(point.position, 1.0);
    }
  }
  for (Facet& facet : cloud.facets) facet.mean = facet.moments.mean();
  return cloud;
}

}  // namespace sgraphs
