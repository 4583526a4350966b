#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/io/ply.h"
#include "tools/eval/mesh_query.h"
#include "tools/eval/trajectory_error.h"

namespace sgraphs {

struct MapError {
  ErrorStatistics distance_m;      // of every map point to the mesh
  std::vector<float> distances_m;  // as the points
  double completeness = 0;         // share of visible_area_m2 with a map point within 5 cm
  double visible_area_m2 = 0;      // of the mesh within 10 m and line of sight of the path
};

// `points_truth` and `path_truth` are in the building's frame. Throws Error if the map is empty.
MapError mapError(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& points_truth,
                  const std::vector<Eigen::Vector3d>& path_truth);

// One place on a mesh and the area it stands for.
struct SurfaceSample {
  Eigen::Vector3d position;
  double area_m2 = 0;
};

// Triangles halved across their longest edge until that is at most `spacing_m`.
std::vector<SurfaceSample> sampleSurface(const TriangleMesh& mesh, double spacing_m);

}  // namespace sgraphs
