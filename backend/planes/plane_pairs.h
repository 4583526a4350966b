#pragma once

#include "backend/graph/situational_graph.h"
#include "backend/planes/plane_association.h"

namespace sgraphs {

// What two mapped planes are to each other.

// The same surface, found twice: same side, coplanar within the gate's surface tolerance where both were
// seen, extents that share a good part of the smaller one; not of two storeys (what was first seen on the
// stairs is of none, and may be one with a wall of either). tilt_sigma_rad: what their tilts are not sure of
// relative to each other; small pieces are not.
bool areOneSurface(const PlaneNode& a, const PlaneNode& b, const AssociationGate& gate,
                   double tilt_sigma_rad = 0);

// The two sides of one wall: upright, antiparallel, each seen from its own side, 3 to 60 cm apart with
// nothing seen between them, extents facing each other.
bool areFacesOfOneWall(const PlaneNode& a, const PlaneNode& b, const Eigen::Vector3d& up_map);

// Level parts of one storey's floor or ceiling: same side, large, within 5 cm of one height.
bool areOneHeight(const PlaneNode& a, const PlaneNode& b, const Eigen::Vector3d& up_map);

}  // namespace sgraphs
