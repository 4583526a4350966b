#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace sgraphs::simulate {

// Surfaces in the building's frame [m].
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;  // counter-clockwise seen from outside
  std::vector<uint8_t> reflectivity;               // per triangle, 0-100 (VLP-16 scale)

  void addTriangle(const std::array<Eigen::Vector3d, 3>& corners, uint8_t surface_reflectivity);

  // Four corners of a plane quadrilateral, counter-clockwise seen from outside.
  void addQuad(const std::array<Eigen::Vector3d, 4>& corners, uint8_t surface_reflectivity);

  // Upright box: `size` along its own axes, which are turned by yaw about z.
  void addBox(const Eigen::Vector3d& center, const Eigen::Vector3d& size, double yaw_rad,
              uint8_t surface_reflectivity);

  // Upright prism over a regular polygon; the first of its corners lies in x from the centre of the base.
  void addPrism(const Eigen::Vector3d& base, double radius, double height, int sides,
                uint8_t surface_reflectivity);
};

// ASCII PLY with float coordinates. Throws Error if the file cannot be written.
void writePly(const std::string& path, const TriangleMesh& mesh);

}  // namespace sgraphs::simulate
