#include "tools/eval/map_error.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#include "common/base/error.h"

namespace sgraphs {
namespace {

constexpr double kSight_m = 10;
constexpr double kNear_m = 0.05;
constexpr double kSampleSpacing_m = 0.14;  // longest edge: legs of 0.1 m
constexpr double kPathStep_m = 0.25;
constexpr double kSightMargin_m = 0.005;
constexpr size_t kBlock = 1024;  // samples that one thread looks at in a row

// Points in cells of the search radius, sorted by cell: found again by binary search.
class PointGrid {
 public:
  PointGrid(const std::vector<Eigen::Vector3d>& points, double radius) : radius_(radius) {
    for (const auto& p : points) entries_.push_back({cellOf(p), p});
    std::sort(entries_.begin(), entries_.end(),
              [](const Entry& a, const Entry& b) { return a.cell < b.cell; });
  }

  bool anyWithinRadius(const Eigen::Vector3d& p) const {
    const Cell center = cellOf(p);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y) {
        // Cells of one column lie side by side.
        const Cell low{center[0] + x, center[1] + y, center[2] - 1};
        const Cell high{low[0], low[1], center[2] + 1};
        auto it = std::lower_bound(entries_.begin(), entries_.end(), low,
                                   [](const Entry& e, const Cell& cell) { return e.cell < cell; });
        for (; it != entries_.end() && it->cell <= high; ++it)
          if ((it->point - p).squaredNorm() <= radius_ * radius_) return true;
      }
    return false;
  }

 private:
  using Cell = std::array<int64_t, 3>;
  struct Entry {
    Cell cell;
    Eigen::Vector3d point;
  };

  Cell cellOf(const Eigen::Vector3d& p) const {
    Cell cell;
    for (int k = 0; k < 3; ++k)
      cell[static_cast<size_t>(k)] = static_cast<int64_t>(std::floor(p[k] / radius_));
    return cell;
  }

  double radius_;
  std::vector<Entry> entries_;
};

// Places where the path has been, apart from each other however often it came by.
std::vector<Eigen::Vector3d> placesOf(const std::vector<Eigen::Vector3d>& path) {
  std::vector<Eigen::Vector3d> places;
  Eigen::Vector3d last = Eigen::Vector3d::Constant(INFINITY);  // that was looked at
  for (const auto& p : path) {
    if ((p - last).norm() < 0.1 * kPathStep_m) continue;
    last = p;
    const bool known = std::any_of(places.rbegin(), places.rend(), [&](const Eigen::Vector3d& q) {
      return (p - q).squaredNorm() < kPathStep_m * kPathStep_m;
    });
    if (!known) places.push_back(p);
  }
  return places;
}

// Nearest viewpoints first: most samples are seen from one of them.
bool seenFromPath(const MeshQuery& query, const Eigen::Vector3d& sample,
                  const std::vector<Eigen::Vector3d>& path, std::vector<std::pair<double, size_t>>& near) {
  near.clear();
  for (size_t i = 0; i < path.size(); ++i) {
    const double squared = (path[i] - sample).squaredNorm();
    if (squared <= kSight_m * kSight_m) near.emplace_back(squared, i);
  }
  // Put in order as far as needed only: a heap.
  std::make_heap(near.begin(), near.end(), std::greater<>());
  for (auto end = near.end(); end != near.begin(); --end) {
    std::pop_heap(near.begin(), end, std::greater<>());
    if (!query.occluded(path[(end - 1)->second], sample, kSightMargin_m)) return true;
  }
  return false;
}

std::vector<double> distancesTo(const MeshQuery& query, const std::vector<Eigen::Vector3d>& points) {
  // Wide enough for any point of a building; a point beyond is as far as the query goes.
  constexpr double kFarthest_m = 1000;
  std::vector<double> distances(points.size());
  tbb::parallel_for(size_t{0}, points.size(), [&](size_t i) {
    distances[i] = query.distance(points[i], kFarthest_m).value_or(kFarthest_m);
  });
  return distances;
}

enum class Coverage : uint8_t { kUnseen, kSeen, kMapped };

std::vector<Coverage> coverageOf(const std::vector<SurfaceSample>& samples, const MeshQuery& query,
                                 const PointGrid& grid, const std::vector<Eigen::Vector3d>& path) {
  std::vector<Coverage> coverage(samples.size(), Coverage::kUnseen);
  const size_t blocks = (samples.size() + kBlock - 1) / kBlock;
  tbb::parallel_for(size_t{0}, blocks, [&](size_t block) {
    std::vector<std::pair<double, size_t>> scratch;
    for (size_t i = block * kBlock; i < std::min(samples.size(), (block + 1) * kBlock); ++i)
      if (seenFromPath(query, samples[i].position, path, scratch))
        coverage[i] = grid.anyWithinRadius(samples[i].position) ? Coverage::kMapped : Coverage::kSeen;
  });
  return coverage;
}

void halve(const std::array<Eigen::Vector3d, 3>& t, double spacing, std::vector<SurfaceSample>& samples) {
  int longest = 0;
  double length = 0;
  for (int k = 0; k < 3; ++k) {
    const double edge = (t[static_cast<size_t>((k + 1) % 3)] - t[static_cast<size_t>(k)]).norm();
    if (edge > length) length = edge, longest = k;
  }
  if (length <= spacing) {
    const double area = 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm();
    samples.push_back({(t[0] + t[1] + t[2]) / 3, area});
    return;
  }
  const auto& a = t[static_cast<size_t>(longest)];
  const auto& b = t[static_cast<size_t>((longest + 1) % 3)];
  const auto& c = t[static_cast<size_t>((longest + 2) % 3)];
  const Eigen::Vector3d middle = 0.5 * (a + b);
  halve({a, middle, c}, spacing, samples);
  halve({middle, b, c}, spacing, samples);
}

}  // namespace

std::vector<SurfaceSample> sampleSurface(const TriangleMesh& mesh, double spacing_m) {
  std::vector<SurfaceSample> samples;
  for (const auto& t : mesh.triangles)
    halve({mesh.vertices[t.x()], mesh.vertices[t.y()], mesh.vertices[t.z()]}, spacing_m, samples);
  return samples;
}

MapError mapError(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& points_truth,
                  const std::vector<Eigen::Vector3d>& path_truth) {
  if (points_truth.empty()) throw Error("map.ply holds no point: nothing was mapped");
  const MeshQuery query(mesh);
  MapError result;
  const auto distances = distancesTo(query, points_truth);
  result.distances_m.assign(distances.begin(), distances.end());
  result.distance_m = statisticsOf(distances);

  const PointGrid grid(points_truth, kNear_m);
  const auto samples = sampleSurface(mesh, kSampleSpacing_m);
  const auto coverage = coverageOf(samples, query, grid, placesOf(path_truth));
  // Summed up in the samples' order, whichever thread looked at them.
  double covered_m2 = 0;
  for (size_t i = 0; i < samples.size(); ++i) {
    if (coverage[i] != Coverage::kUnseen) result.visible_area_m2 += samples[i].area_m2;
    if (coverage[i] == Coverage::kMapped) covered_m2 += samples[i].area_m2;
  }
  if (result.visible_area_m2 > 0) result.completeness = covered_m2 / result.visible_area_m2;
  return result;
}

}  // namespace sgraphs
