#include "perception/odometry/surfel_map.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace sgraphs {
namespace {

// A cell must have seen this many patches' worth of points before its own plane is used.
constexpr double kMinCount = 12;
// Scatter of sensor noise is at least this thick, so that few lucky points claim no perfect plane.
constexpr double kMinThickness2 = 1e-4;
// A second facing counts if the normal's second component is at least this share of the first (8 degrees
// around 45).
constexpr double kSecondFacing = 0.75;
// A cell that has seen so much learns nothing more: a robot that stands for hours must not weigh it down.
constexpr double kMaxCount = 20000;
constexpr double kMergeCos = 0.8;

// Plane of the cell from its scatter; the first patch's normal decides the side.
void updatePlane(MapCell& cell) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(cell.scatter / cell.count);
  Eigen::Vector3d normal = eigen.eigenvectors().col(0).normalized();
  if (normal.dot(cell.normal) < 0) normal = -normal;
  cell.normal = normal;
  const double thickness2 = std::max(eigen.eigenvalues()[0], kMinThickness2);
  cell.variance_m2 = thickness2 / cell.count;
  // A plane that does not know its normal is of no use beyond its mean.
  cell.tilt_variance = std::min(normalVariance(thickness2, eigen.eigenvalues()[1], cell.count), 1.0);
}

}  // namespace

SurfelMap::Addresses SurfelMap::addressesOf(const Eigen::Vector3d& point,
                                            const Eigen::Vector3d& normal) const {
  Addresses out{};
  Eigen::Vector3d size = normal.cwiseAbs();
  double largest = 0;
  for (out.count = 0; out.count < 2; ++out.count) {
    Address& a = out.at[out.count];
    const double value = size.maxCoeff(&a.axis);
    if (out.count == 1 && value < kSecondFacing * largest) break;
    largest = value;
    size[a.axis] = 0;
    for (int i = 0; i < 3; ++i) a.cube[i] = static_cast<int>(std::floor(point[i] / cell_m_));
    a.facing = static_cast<uint64_t>(2 * a.axis + (normal[a.axis] < 0));
  }
  return out;
}

int32_t SurfelMap::find(Address a, int step) const {
  a.cube[a.axis] += step;
  return index_.find(VoxelIndex::pack(a.cube.x(), a.cube.y(), a.cube.z(), a.facing));
}

template <typename Usable>
int32_t SurfelMap::nearest(const Addresses& addresses, const Eigen::Vector3d& point, double within_m,
                           Usable usable) const {
  int32_t best = -1;
  for (int k = 0; k < addresses.count; ++k) {
    for (const int step : {0, -1, 1}) {
      const int32_t i = find(addresses.at[k], step);
      if (i < 0) continue;
      const MapCell& cell = cells_[static_cast<size_t>(i)];
      if (!usable(cell)) continue;
      const double distance = std::abs(cell.normal.dot(point - cell.mean));
      if (distance < within_m) {
        within_m = distance;
        best = i;
      }
    }
  }
  return best;
}

void SurfelMap::insert(const Surfel& s, const SE3& T_map_body, double merge_m) {
  const Eigen::Vector3d mean = T_map_body * s.mean;
  const Eigen::Vector3d normal = T_map_body.rotation * s.normal;
  const Eigen::Matrix3d R = T_map_body.matrix3();
  const Eigen::Matrix3d scatter = s.count * (R * s.covariance * R.transpose());
  const Addresses addresses = addressesOf(mean, normal);
  const int32_t best = nearest(addresses, mean, merge_m,
                               [&](const MapCell& cell) { return cell.normal.dot(normal) > kMergeCos; });
  if (best < 0) {
    // The cube's own cell may hold another surface farther away: then this one finds no place.
    if (find(addresses.at[0], 0) >= 0) return;
    const Address& a = addresses.at[0];
    MapCell cell;
    cell.mean = mean;
    cell.normal = normal;
    cell.scatter = scatter;
    cell.count = s.count;
    cell.key = VoxelIndex::pack(a.cube.x(), a.cube.y(), a.cube.z(), a.facing);
    updatePlane(cell);
    index_.insert(cell.key, static_cast<int32_t>(cells_.size()));
    cells_.push_back(cell);
    return;
  }
  MapCell& cell = cells_[static_cast<size_t>(best)];
  if (cell.count > kMaxCount) return;
  const double total = cell.count + s.count;
  const Eigen::Vector3d d = mean - cell.mean;
  cell.scatter += scatter + (cell.count * s.count / total) * d * d.transpose();
  cell.mean += (s.count / total) * d;
  cell.count = total;
  updatePlane(cell);
}

const MapCell* SurfelMap::match(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double gate_m,
                                double min_cos) const {
  const int32_t best = nearest(addressesOf(point, normal), point, gate_m, [&](const MapCell& cell) {
    return cell.count >= kMinCount && cell.normal.dot(normal) > min_cos;
  });
  return best < 0 ? nullptr : &cells_[static_cast<size_t>(best)];
}

void SurfelMap::prune(const Eigen::Vector3d& centre, double radius_m) {
  std::vector<MapCell> kept;
  kept.reserve(cells_.size());
  for (const MapCell& cell : cells_)
    if ((cell.mean - centre).squaredNorm() < radius_m * radius_m) kept.push_back(cell);
  if (kept.size() == cells_.size()) return;
  cells_ = std::move(kept);
  index_.clear();
  for (size_t i = 0; i < cells_.size(); ++i) index_.insert(cells_[i].key, static_cast<int32_t>(i));
}

}  // namespace sgraphs
