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

// First surface along a ray, by Embree; panes of glass are asked for apart, as what they do to a ray is the
// sensor's matter. The same ray gives the same bits whatever thread asks, on any
// processor with SSE 4.2. Coordinates are single precision: ranges are good to about 10 um within 100 m.
class RayCaster {
 public:
  // Throws Error if the mesh of opaque surfaces has no triangle; there need not be glass.
  explicit RayCaster(const TriangleMesh& mesh, const TriangleMesh& glass = {});
  ~RayCaster();
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  // First opaque surface. `direction` is a unit vector. Safe to call from several threads.
  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                             double max_range_m) const;

  // First pane of glass between two ranges, whatever opaque surface stands before it.
  bool hasGlass() const;
  std::optional<RayHit> castGlass(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                  double min_range_m, double max_range_m) const;

  // Distance from a point to the nearest surface, panes included [m]; tests every triangle, for tests and
  // small meshes.
  double distanceToSurface(const Eigen::Vector3d& point) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgraphs::simulate
