#include "tools/simulate/building/triangle_mesh.h"

#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/base/error.h"

namespace sgraphs::simulate {

void TriangleMesh::addTriangle(const std::array<Eigen::Vector3d, 3>& corners, uint8_t surface_reflectivity) {
  const auto first = static_cast<uint32_t>(vertices.size());
  vertices.insert(vertices.end(), corners.begin(), corners.end());
  triangles.push_back({first, first + 1, first + 2});
  reflectivity.push_back(surface_reflectivity);
}

void TriangleMesh::addQuad(const std::array<Eigen::Vector3d, 4>& corners, uint8_t surface_reflectivity) {
  const auto first = static_cast<uint32_t>(vertices.size());
  vertices.insert(vertices.end(), corners.begin(), corners.end());
  triangles.push_back({first, first + 1, first + 2});
  triangles.push_back({first, first + 2, first + 3});
  reflectivity.insert(reflectivity.end(), 2, surface_reflectivity);
}

void TriangleMesh::addBox(const Eigen::Vector3d& center, const Eigen::Vector3d& size, double yaw_rad,
                          uint8_t surface_reflectivity) {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  // Corner i: bit 0 chooses the side in x, bit 1 in y, bit 2 in z.
  std::array<Eigen::Vector3d, 8> p;
  for (size_t i = 0; i < 8; ++i) {
    const double x = (i & 1 ? 0.5 : -0.5) * size.x(), y = (i & 2 ? 0.5 : -0.5) * size.y();
    p[i] = center + Eigen::Vector3d(c * x - s * y, s * x + c * y, (i & 4 ? 0.5 : -0.5) * size.z());
  }
  for (const auto& f : {std::array<size_t, 4>{0, 4, 6, 2},
                        {1, 3, 7, 5},
                        {0, 1, 5, 4},
                        {2, 6, 7, 3},
                        {0, 2, 3, 1},
                        {4, 5, 7, 6}})
    addQuad({p[f[0]], p[f[1]], p[f[2]], p[f[3]]}, surface_reflectivity);
}

void TriangleMesh::addPrism(const Eigen::Vector3d& base, double radius, double height, int sides,
                            uint8_t surface_reflectivity) {
  const Eigen::Vector3d up(0, 0, height);
  const auto corner = [&](int i) {
    const double angle = 2 * std::numbers::pi * (i % sides) / sides;
    return Eigen::Vector3d(base + radius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0));
  };
  for (int i = 0; i < sides; ++i) {
    const Eigen::Vector3d a = corner(i), b = corner(i + 1);
    addQuad({a, b, b + up, a + up}, surface_reflectivity);
    addTriangle({base, b, a}, surface_reflectivity);
    addTriangle({base + up, a + up, b + up}, surface_reflectivity);
  }
}

void writePly(const std::string& path, const TriangleMesh& mesh) {
  std::FILE* out = std::fopen(path.c_str(), "w");
  if (!out) throw Error("cannot write '" + path + "': check the folder and its permissions");
  std::fprintf(out,
               "ply\nformat ascii 1.0\nelement vertex %zu\nproperty float x\nproperty float y\n"
               "property float z\nelement face %zu\nproperty list uchar int vertex_indices\nend_header\n",
               mesh.vertices.size(), mesh.triangles.size());
  for (const auto& v : mesh.vertices) std::fprintf(out, "%.5f %.5f %.5f\n", v.x(), v.y(), v.z());
  for (const auto& t : mesh.triangles) std::fprintf(out, "3 %u %u %u\n", t[0], t[1], t[2]);
  const bool failed = std::ferror(out) != 0;
  if (std::fclose(out) != 0 || failed) throw Error("cannot write '" + path + "': is the disk full?");
}

}  // namespace sgraphs::simulate
