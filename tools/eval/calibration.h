#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/io/tum.h"

namespace sgraphs {

// A measured transform between two instants' bodies, as graph.json exports it.
struct MeasuredLink {
  std::string kind;
  Time from;
  Time to;
  SE3 T_from_to;
  Matrix6d covariance = Matrix6d::Identity();  // of the right perturbation: translation [m], rotation [rad]
};

// Links of graph.json that carry a measurement and a covariance. Throws Error naming the file and what is
// wrong with it.
std::vector<MeasuredLink> readMeasuredLinks(const std::string& graph_json_path);

// Normalised estimation error squared: 3 on average, and 95 % inside, if a covariance is what it claims to
// be.
struct Calibration {
  size_t count = 0;
  double nees_translation = 0;  // mean over the links
  double nees_rotation = 0;
  double inside_translation = 0;  // share within the 95 % ellipsoid
  double inside_rotation = 0;
};

// Per kind of link, against the truth at both ends; links outside the truth's time are left out.
std::map<std::string, Calibration> calibrationOf(const std::vector<MeasuredLink>& links,
                                                 const std::vector<StampedPose>& truth);

}  // namespace sgraphs
