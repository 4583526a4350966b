#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "common/io/ply.h"

namespace sgraphs {

// Distances to and sight lines through a triangle mesh, by Embree (which stays out of the header). Several
// threads may ask at once.
class MeshQuery {
 public:
  explicit MeshQuery(const TriangleMesh& mesh);
  ~MeshQuery();

  // Distance [m] to the nearest point of any triangle, none beyond max_distance_m.
  std::optional<double> distance(const Eigen::Vector3d& point, double max_distance_m) const;

  // Whether a triangle cuts the segment; its last `margin_m` before `to` is not looked at, so that the
  // surface that holds `to` does not hide it.
  bool occluded(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double margin_m) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgraphs
