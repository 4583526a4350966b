#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/se3.h"

namespace sgraphs {

// A plane segment seen from one keyframe. Its axes are u, v = tangentBasis(normal_body).
struct PlaneObservation {
  Eigen::Vector3d normal_body = Eigen::Vector3d::UnitZ();   // unit, towards the observer
  Eigen::Vector3d centroid_body = Eigen::Vector3d::Zero();  // on the plane, centre of its information [m]
  // Of (tilt_u [rad], tilt_v [rad], offset [m]) at the centroid: the true normal is n + tilt_u u + tilt_v v,
  // and the true plane passes at centroid + offset n.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  int num_points = 0;  // raw points behind it
  double rms_m = 0;    // root mean square distance of the points
  double area_m2 = 0;  // of the boundary
  // Polygon in the plane: (u, v) from the centroid [m], counter-clockwise seen from the observer, not closed.
  std::vector<Eigen::Vector2f> boundary;

  // n.p + d = 0 in body; positive, since the normal points to the observer, unless the body has passed the
  // plane since (through a doorway, within one keyframe).
  double d() const { return -normal_body.dot(centroid_body); }
};

// The planes seen from one keyframe, largest area first.
struct KeyframePlanes {
  KeyframeId keyframe;
  Time time;  // of the keyframe
  std::vector<PlaneObservation> planes;
  // Standard deviations, translation [m] then rotation [rad] in body, of the keyframe's own pose in the cloud
  // that the planes were seen in: an error that all of them share, contained in each covariance.
  Vector6d pose_sigma = Vector6d::Zero();
};

// The map axis a mapped plane's normal is nearest to, relative to the building's own axes.
enum class PlaneLabel : int8_t { kX = 1, kY = 2, kHorizontal = 3 };

// A plane of the map as GRAPH_UPDATE tells it to the other stages. Its axes are u, v =
// tangentBasis(normal_map).
struct MapPlane {
  PlaneId id;
  PlaneId merged_into;  // valid: this plane lives on in that one, and nothing below means anything
  FloorId floor;
  PlaneLabel label = PlaneLabel::kHorizontal;
  Eigen::Vector3d normal_map = Eigen::Vector3d::UnitZ();     // unit, towards the side it was seen from
  double d = 0;                                              // n.p + d = 0 [m]
  Eigen::Vector3d centroid_map = Eigen::Vector3d::Zero();    // centre of the extent, on the plane [m]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // of (tilt_u [rad], tilt_v [rad], offset [m])
  std::vector<Eigen::Vector3f> polygon_map;  // extent, counter-clockwise seen from the observer [m]
};

}  // namespace sgraphs
