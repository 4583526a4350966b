#include "perception/planes/facets.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "perception/odometry/voxel_index.h"

namespace sgraphs {
namespace {

constexpr int kLevels = 4;  // of cell sizes
// Largest ratio of the variances across and along a surface. Where two walls meet in the middle of a
// neighbourhood it is 1/4; for a wall of 5 cm seen from both sides, 1/9.
constexpr double kMaxThinness = 0.15;
// Returns nearer than this to their viewpoint have no direction of view; farther ones are none of a LiDAR.
constexpr double kMinRange_m = 1e-3;
constexpr double kMaxRange_m = 300;
constexpr double kMaxPlace_m = 10'000;  // from the keyframe

struct Cell {
  uint64_t key = 0;
  int level = 0;
  PlaneMoments moments;
  int32_t facets[2] = {-1, -1};  // seen from the normal's side and from the other
};

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
    if (!(point.range_m > kMinRange_m && point.range_m < kMaxRange_m &&
          point.position.cwiseAbs().maxCoeff() < kMaxPlace_m))
      continue;
    point.to_viewpoint = ray / point.range_m;
    point.count = p.count;
    point.scan = p.scan;
    points.push_back(point);
  }
  return points;
}

class CellGrid {
 public:
  explicit CellGrid(const FacetConfig& config) : config_(config) { cells.reserve(8192); }

  double sizeOf(int level) const { return config_.cell_m * (1 << level); }

  void add(const ViewedPoint& point) {
    int level = 0;
    while (level + 1 < kLevels && point.range_m > config_.cell_range_m * (1 << level)) ++level;
    const Eigen::Vector3d at = (point.position / sizeOf(level)).array().floor();
    const uint64_t key = VoxelIndex::pack(static_cast<int64_t>(at.x()), static_cast<int64_t>(at.y()),
                                          static_cast<int64_t>(at.z()), static_cast<uint64_t>(level));
    int32_t i = index_.find(key);
    if (i < 0) {
      i = static_cast<int32_t>(cells.size());
      index_.insert(key, i);
      cells.push_back({key, level, {}});
    }
    cells[static_cast<size_t>(i)].moments.add(point.position, 1.0);
    cell_of_point.push_back(i);
  }

  // Calls visit(cell, moments of it and its 26 neighbours) for each cell. In the order of keys the cells of a
  // column stand together, and each of the nine columns around a cell is followed by a cursor of its own.
  template <typename Visit>
  void forEachNeighbourhood(Visit visit) {
    std::vector<int32_t> order(cells.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [this](int32_t a, int32_t b) { return at(a).key < at(b).key; });
    size_t cursors[9] = {};
    for (const int32_t i : order) {
      PlaneMoments sum;
      size_t* cursor = cursors;
      for (const uint64_t dx : {~uint64_t{0}, uint64_t{0}, uint64_t{1}})
        for (const uint64_t dy : {~uint64_t{0}, uint64_t{0}, uint64_t{1}}) {
          const uint64_t middle = at(i).key + (dx << 40) + (dy << 20);
          while (*cursor < order.size() && at(order[*cursor]).key < middle - 1) ++*cursor;
          for (size_t k = *cursor; k < order.size() && at(order[k]).key <= middle + 1; ++k)
            sum.add(at(order[k]).moments);
          ++cursor;
        }
      visit(at(i), sum);
    }
  }

  std::vector<Cell> cells;
  std::vector<int32_t> cell_of_point;

 private:
  Cell& at(int32_t i) { return cells[static_cast<size_t>(i)]; }

  FacetConfig config_;
  VoxelIndex index_;
};

struct Surface {
  Eigen::Vector3d normal;  // without sign
  double thickness_m;
};

// Nothing where the points are no surface, or too few to tell.
std::optional<Surface> surfaceOf(const PlaneMoments& moments, const FacetConfig& config) {
  if (moments.weight < config.min_points) return std::nullopt;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(moments.covariance());
  const double thin = std::max(eigen.eigenvalues()(0), 0.0), wide = eigen.eigenvalues()(1);
  if (thin > config.max_thickness_m * config.max_thickness_m || thin > kMaxThinness * wide)
    return std::nullopt;
  // Variance of an eigenvector (Anderson, "Asymptotic theory for principal component analysis", 1963).
  const double variance = thin * wide / (moments.weight * (wide - thin) * (wide - thin));
  if (variance > config.max_normal_sigma_rad * config.max_normal_sigma_rad) return std::nullopt;
  return Surface{eigen.eigenvectors().col(0).normalized(), std::sqrt(thin)};
}

}  // namespace

FacetCloud makeFacets(const Keyframe& keyframe, const FacetConfig& config) {
  FacetCloud cloud;
  cloud.points = viewedPoints(keyframe);
  CellGrid grid(config);
  for (const ViewedPoint& point : cloud.points) grid.add(point);
  std::vector<Eigen::Vector3d> normals(grid.cells.size(), Eigen::Vector3d::Zero());
  std::vector<double> thickness;
  grid.forEachNeighbourhood([&](const Cell& cell, const PlaneMoments& moments) {
    const std::optional<Surface> surface = surfaceOf(moments, config);
    if (!surface) return;
    normals[static_cast<size_t>(&cell - grid.cells.data())] = surface->normal;
    thickness.push_back(surface->thickness_m);
  });
  if (!thickness.empty()) {
    const auto middle = thickness.begin() + static_cast<std::ptrdiff_t>(thickness.size() / 2);
    std::nth_element(thickness.begin(), middle, thickness.end());
    cloud.thickness_m = *middle;
  }
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    ViewedPoint& point = cloud.points[i];
    const auto c = static_cast<size_t>(grid.cell_of_point[i]);
    Cell& cell = grid.cells[c];
    const double facing = normals[c].dot(point.to_viewpoint);
    if (facing == 0) continue;  // no normal
    int32_t& facet = cell.facets[facing < 0];
    if (facet < 0) {
      facet = static_cast<int32_t>(cloud.facets.size());
      const double size_m = grid.sizeOf(cell.level);
      cloud.facets.push_back(
          {{}, Eigen::Vector3d::Zero(), facing < 0 ? -normals[c] : normals[c], size_m * size_m});
    }
    point.facet = facet;
    cloud.facets[static_cast<size_t>(facet)].moments.add(point.position, 1.0);
  }
  for (Facet& facet : cloud.facets) facet.mean = facet.moments.mean();
  return cloud;
}

}  // namespace sgraphs
