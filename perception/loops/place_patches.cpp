#include "perception/loops/place_patches.h"

#include <array>
#include <cmath>
#include <optional>

#include "perception/odometry/knn_surfels.h"
#include "perception/odometry/voxel_index.h"

namespace sgraphs {
namespace {

struct Level {
  double reach_m;
  double cube_m;
};
constexpr std::array<Level, 3> kLevels{{{8.0, 0.4}, {16.0, 0.8}, {40.0, 1.6}}};
constexpr float kUprightNormal = 0.5F;  // |n_z| below: a wall, above: a floor or ceiling

// One cube's points that were seen from one side.
struct Cell {
  PatchMoments moments;
  Eigen::Vector3d viewpoint;
};

uint64_t viewClass(const Eigen::Vector3d& ray) {
  Eigen::Index axis = 0;
  ray.cwiseAbs().maxCoeff(&axis);
  return static_cast<uint64_t>(2 * axis + (ray[axis] < 0));
}

// Cubes of one size, in the order in which points opened them.
class Cubes {
 public:
  explicit Cubes(double edge_m) : edge_m_(edge_m) {}

  void add(const Eigen::Vector3d& point, const Eigen::Vector3d& viewpoint) {
    const Eigen::Vector3d cube = (point / edge_m_).array().floor();
    const uint64_t key = VoxelIndex::pack(static_cast<int64_t>(cube.x()), static_cast<int64_t>(cube.y()),
                                          static_cast<int64_t>(cube.z()), viewClass(point - viewpoint));
    int32_t i = index_.find(key);
    if (i < 0) {
      i = static_cast<int32_t>(cells_.size());
      index_.insert(key, i);
      cells_.push_back({PatchMoments(point), viewpoint});
    }
    cells_[static_cast<size_t>(i)].moments.add(point);
  }

  void patches(std::vector<Surfel>& upright, std::vector<Surfel>& level) const {
    for (const Cell& cell : cells_) {
      std::optional<Surfel> s = cell.moments.surfel(SurfelConfig(), 0);
      if (!s) continue;
      if (s->normal.dot(cell.viewpoint - s->mean) < 0) s->normal = -s->normal;
      (std::abs(s->normal.z()) < kUprightNormal ? upright : level).push_back(*s);
    }
  }

 private:
  double edge_m_;
  std::vector<Cell> cells_;
  VoxelIndex index_;
};

void appendThinned(const std::vector<Surfel>& all, size_t max, std::vector<Surfel>& out) {
  const size_t n = std::min(all.size(), max);
  for (size_t i = 0; i < n; ++i) out.push_back(all[i * all.size() / n]);
}

}  // namespace

std::vector<Surfel> patchesOf(const Keyframe& keyframe, size_t max_upright, size_t max_level) {
  std::vector<Cubes> levels;
  levels.reserve(kLevels.size());
  for (const Level& level : kLevels) levels.emplace_back(level.cube_m);
  for (const KeyframePoint& p : keyframe.points) {
    const Eigen::Vector3d viewpoint = keyframe.T_keyframe_body[p.scan] * keyframe.T_body_lidar.translation;
    const Eigen::Vector3d point = p.position_body.cast<double>();
    const double range = (point - viewpoint).norm();
    for (size_t i = 0; i < kLevels.size(); ++i) {
      if (range >= kLevels[i].reach_m) continue;
      levels[i].add(point, viewpoint);
      break;
    }
  }
  std::vector<Surfel> upright, level;
  for (const Cubes& cubes : levels) cubes.patches(upright, level);
  std::vector<Surfel> out;
  appendThinned(upright, max_upright, out);
  appendThinned(level, max_level, out);
  return out;
}

PackedPatch::PackedPatch(const Surfel& s)
    : mean_(s.mean.cast<float>()),
      normal_(s.normal.cast<float>()),
      variance_m2_(static_cast<float>(s.variance_m2)),
      count_(static_cast<float>(s.count)) {
  int k = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = r; c < 3; ++c) covariance_[k++] = static_cast<float>(s.covariance(r, c));
}

Surfel PackedPatch::unpack() const {
  Surfel s;
  s.mean = mean_.cast<double>();
  s.normal = normal_.cast<double>().normalized();
  int k = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = r; c < 3; ++c) s.covariance(r, c) = s.covariance(c, r) = covariance_[k++];
  s.variance_m2 = variance_m2_;
  s.count = count_;
  return s;
}

}  // namespace sgraphs
