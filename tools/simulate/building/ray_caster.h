#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "tools/simulate/building/triangle_mesh.h"

namespace sgraphs::simulate {

struct RayHit {
  double range_m = 0;
  double cos_incidence = 0;  // between ray and surface normal, 0 to 1
  uint8_t reflectivity = 0;
};

// First surface along a ray, by Embree. The same ray gives the same bits whatever thread asks, on any
// processor with SSE 4.2. Coordinates are single precision: ranges are good to about 10 um within 100 m.
class RayCaster {
 public:
  // Throws Error if the mesh has no triangle.
  explicit RayCaster(const TriangleMesh& mesh);
  ~RayCaster();
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  // `direction` is a unit vector. Safe to call from several threads.
  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                             double max_range_m) const;

  // Distance from a point to the nearest surface [m]; tests every triangle, for tests and small meshes.
  double distanceToSurface(const Eigen::Vector3d& point) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgraphs::simulate
