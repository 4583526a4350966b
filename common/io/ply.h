#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace sgraphs {

struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;   // [m]
  std::vector<Eigen::Vector3i> triangles;  // indices of vertices, counter-clockwise seen from outside
};

// Points with the storey each belongs to; `floors` is empty if the file does not say.
struct PointCloud {
  std::vector<Eigen::Vector3f> points;  // [m]
  std::vector<uint8_t> floors;
};

// PLY, ascii or binary little-endian: the elements "vertex" (x y z, other properties are skipped) and "face"
// (a list of vertex indices; polygons are cut into fans). Throws Error naming the file and what is wrong with
// it.
TriangleMesh readPlyMesh(const std::string& path);
PointCloud readPlyPoints(const std::string& path);

// Binary little-endian float32 x y z, and uint8 floor if `floors` is not empty.
void writePlyPoints(const std::string& path, const PointCloud& cloud);

// ASCII, as other tools and people read it.
void writePlyMesh(const std::string& path, const TriangleMesh& mesh);

}  // namespace sgraphs
