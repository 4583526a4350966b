#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "common/types/keyframe.h"
#include "perception/odometry/registration.h"

namespace sgraphs {

// The paper's hard constraint between neighbouring keyframes: their clouds are registered to each other,
// whatever the odometry mode.
class KeyframeRegistration {
 public:
  KeyframeRegistration(const RegistrationConfig& registration, const CovarianceConfig& covariance);

  // Registers the patches of a new keyframe (in its body) against the previous keyframes and remembers them.
  std::vector<RelativePose> step(KeyframeId id, const SE3& T_odom_body, const std::vector<Surfel>& surfels,
                                 int threads);

 private:
  struct Reference {
    KeyframeId id;
    SE3 T_odom_body;
    SurfelMap map;
  };
  RegistrationConfig registration_;
  CovarianceConfig covariance_;
  std::deque<Reference> references_;
};

}  // namespace sgraphs
