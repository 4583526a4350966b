#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

#include "common/geometry/se3.h"
#include "tools/simulate/building/triangle_mesh.h"

namespace sgraphs::simulate {

// What is done to meshes that come from files.

// Reflectivity of surfaces whose material the simulator does not know (VLP-16 scale).
inline constexpr uint8_t kMeshReflectivity = 50;

// Adds a triangle over vertices that the mesh has.
void addTriangle(TriangleMesh& mesh, const std::array<uint32_t, 3>& corners, uint8_t reflectivity);

// Adds `other`, each vertex v of it at T * (scale .* v).
void append(TriangleMesh& mesh, const TriangleMesh& other, const SE3& T_mesh_other = {},
            const Eigen::Vector3d& scale = Eigen::Vector3d::Ones());

// Upright prism about the z axis, the middle of its height at the origin.
TriangleMesh makeCylinder(double radius_m, double height_m);

Eigen::AlignedBox3d boundsOf(const TriangleMesh& mesh);
bool isFinite(const TriangleMesh& mesh);

// Removes triangles without area, which no ray can meet; returns their number.
int64_t dropDegenerate(TriangleMesh& mesh);

// Edges that only one triangle has, once vertices closer than 1e-5 m are taken for one: the rims of holes,
// and of surfaces without thickness.
struct OpenEdges {
  int64_t count = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();  // middle of the first one, in order of the triangles
};
OpenEdges findOpenEdges(const TriangleMesh& mesh);

}  // namespace sgraphs::simulate
