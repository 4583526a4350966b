#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/types/plane.h"
#include "tools/simulate/scene/test_worlds.h"

namespace sgraphs::testing_support {

// Error of an observation against the true surface, in the terms of its covariance.
struct PlaneError {
  Eigen::Vector3d error = Eigen::Vector3d::Zero();  // tilt_u, tilt_v, offset
  Eigen::Vector3d centroid_building = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_building = Eigen::Vector3d::UnitZ();  // the true one

  double tiltNees(const PlaneObservation& plane) const;    // 2 degrees of freedom
  double offsetNees(const PlaneObservation& plane) const;  // 1
};

// The surface of the building that the observation shows: the one that faces the same way (within 0.35 rad)
// nearest to its centroid; nothing if that is farther than 0.1 m, which makes the plane an invention.
std::optional<PlaneError> errorOf(const PlaneObservation& plane, const SE3& T_building_body,
                                  const simulate::TriangleMesh& mesh);

}  // namespace sgraphs::testing_support
