#pragma once

#include "backend/graph/situational_graph.h"
#include "backend/planes/plane_association.h"

namespace sgraphs {

// What two mapped planes are to each other.

// The same surface, found twice: same side, coplanar within the gate's surface tolerance, extents that meet.
bool areOneSurface(const PlaneNode& a, const PlaneNode& b, const AssociationGate& gate);

// The two sides of one wall: upright, antiparallel, each seen from its own side, 3 to 60 cm apart with
// nothing seen between them, extents facing each other.
bool areFacesOfOneWall(const PlaneNode& a, const PlaneNode& b, const Eigen::Vector3d& up_map);

// Level parts of one storey's floor or ceiling: same side, large, within 5 cm of one height.
bool areOneHeight(const PlaneNode& a, const PlaneNode& b, const Eigen::Vector3d& up_map);

}  // namespace sgraphs
