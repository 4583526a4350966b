#include "tools/simulate/building/mesh_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <unordered_map>

namespace sgraphs::simulate {
namespace {

constexpr double kWeld_m = 1e-5;
constexpr double kLeastArea_m2 = 1e-10;
constexpr int kCylinderSides = 24;

using Cell = std::array<int64_t, 3>;

struct CellHash {
  size_t operator()(const Cell& c) const {
    uint64_t h = 0;
    for (const int64_t i : c) h = (h ^ static_cast<uint64_t>(i)) * 0x9e3779b97f4a7c15ULL;
    return static_cast<size_t>(h ^ (h >> 29));
  }
};

// Gives each point the number of an earlier one within kWeld_m of it, and equal points the same number.
// Looked up, never iterated.
class Welder {
 public:
  explicit Welder(const std::vector<Eigen::Vector3d>& points) : points_(points) {}

  uint32_t add(uint32_t index) {
    const Eigen::Vector3d& p = points_[index];
    const auto [known, fresh] = equal_.try_emplace({p.x(), p.y(), p.z()}, index);
    if (fresh) known->second = near(index);
    return known->second;
  }

 private:
  uint32_t near(uint32_t index) {
    const Eigen::Vector3d& p = points_[index];
    Cell cell;
    for (int i = 0; i < 3; ++i)
      cell[static_cast<size_t>(i)] = static_cast<int64_t>(std::floor(p[i] / kWeld_m));
    for (int64_t k = 0; k < 27; ++k) {
      const auto found = cells_.find({cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1});
      if (found != cells_.end() && (points_[found->second] - p).norm() <= kWeld_m) return found->second;
    }
    cells_.emplace(cell, index);
    return index;
  }

  const std::vector<Eigen::Vector3d>& points_;
  std::map<std::array<double, 3>, uint32_t> equal_;
  std::unordered_map<Cell, uint32_t, CellHash> cells_;
};

}  // namespace

void addTriangle(TriangleMesh& mesh, const std::array<uint32_t, 3>& corners, uint8_t reflectivity) {
  mesh.triangles.push_back(corners);
  mesh.reflectivity.push_back(reflectivity);
}

void append(TriangleMesh& mesh, const TriangleMesh& other, const SE3& T_mesh_other,
            const Eigen::Vector3d& scale) {
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  for (const Eigen::Vector3d& v : other.vertices)
    mesh.vertices.push_back(T_mesh_other * Eigen::Vector3d(scale.cwiseProduct(v)));
  for (size_t i = 0; i < other.triangles.size(); ++i) {
    const auto& t = other.triangles[i];
    addTriangle(mesh, {first + t[0], first + t[1], first + t[2]}, other.reflectivity[i]);
  }
}

TriangleMesh makeCylinder(double radius_m, double height_m) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, -0.5 * height_m}, {0, 0, 0.5 * height_m}};
  for (int i = 0; i < kCylinderSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCylinderSides;
    const double x = radius_m * std::cos(angle), y = radius_m * std::sin(angle);
    mesh.vertices.insert(mesh.vertices.end(), {{x, y, -0.5 * height_m}, {x, y, 0.5 * height_m}});
  }
  for (uint32_t i = 0; i < kCylinderSides; ++i) {
    const uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % kCylinderSides);
    addTriangle(mesh, {a, b, b + 1}, kMeshReflectivity);
    addTriangle(mesh, {a, b + 1, a + 1}, kMeshReflectivity);
    addTriangle(mesh, {0, b, a}, kMeshReflectivity);
    addTriangle(mesh, {1, a + 1, b + 1}, kMeshReflectivity);
  }
  return mesh;
}

Eigen::AlignedBox3d boundsOf(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d bounds;
  for (const auto& t : mesh.triangles)
    for (const uint32_t i : t) bounds.extend(mesh.vertices[i]);
  return bounds;
}

bool isFinite(const TriangleMesh& mesh) {
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const auto& v) { return v.allFinite(); });
}

int64_t dropDegenerate(TriangleMesh& mesh) {
  TriangleMesh kept;
  kept.vertices = std::move(mesh.vertices);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const Eigen::Vector3d &a = kept.vertices[t[0]], &b = kept.vertices[t[1]], &c = kept.vertices[t[2]];
    if (0.5 * (b - a).cross(c - a).norm() > kLeastArea_m2) addTriangle(kept, t, mesh.reflectivity[i]);
  }
  const auto dropped = static_cast<int64_t>(mesh.triangles.size() - kept.triangles.size());
  mesh = std::move(kept);
  return dropped;
}

OpenEdges findOpenEdges(const TriangleMesh& mesh) {
  Welder welder(mesh.vertices);
  std::vector<uint32_t> welded(mesh.vertices.size());
  for (uint32_t i = 0; i < welded.size(); ++i) welded[i] = welder.add(i);
  // Lower and higher vertex of each edge, and where it came from.
  std::vector<std::tuple<uint32_t, uint32_t, size_t>> edges;
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    for (size_t k = 0; k < 3; ++k) {
      const auto& t = mesh.triangles[i];
      const uint32_t a = welded[t[k]], b = welded[t[(k + 1) % 3]];
      if (a != b) edges.emplace_back(std::min(a, b), std::max(a, b), 3 * i + k);
    }
  std::sort(edges.begin(), edges.end());
  OpenEdges open;
  size_t first = 3 * mesh.triangles.size();
  for (size_t i = 0, next = 0; i < edges.size(); i = next) {
    const auto [a, b, at] = edges[i];
    for (next = i; next < edges.size() && std::get<0>(edges[next]) == a && std::get<1>(edges[next]) == b;)
      ++next;
    if (next - i > 1) continue;
    ++open.count;
    if (at >= first) continue;
    first = at;
    open.first = 0.5 * (mesh.vertices[a] + mesh.vertices[b]);
  }
  return open;
}

}  // namespace sgraphs::simulate
