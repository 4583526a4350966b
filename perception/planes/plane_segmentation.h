#pragma once

#include <vector>

#include "common/types/keyframe.h"
#include "common/types/plane.h"
#include "perception/planes/planes_config.h"

namespace sgraphs {

// A keyframe's cloud becomes planes: walls, floors, ceilings and large furniture alike.
//
// Facets with normals towards their viewpoints -> sequential RANSAC over facets -> per plane its points: near
// it, seen from its front, and with its normal -> connected segments -> each refitted on its own, with
// covariance and outline. A wall seen from both sides is two planes, however thin. What is seen of one face
// on both sides of a doorway is one segment if something joins it (the lintel above), else two: nothing in
// one keyframe tells one wall with a doorway from the walls of two rooms that end at a corridor.
//
// A pure function of the keyframe: seeds come from its id.
class PlaneSegmentation {
 public:
  explicit PlaneSegmentation(const PlanesConfig& config = {}) : config_(config) {}

  KeyframePlanes step(const Keyframe& keyframe) const;

 private:
  PlanesConfig config_;
};

}  // namespace sgraphs
