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
  // `anchor_covariance`: how far the keyframe's pose may lie off its own cloud, which is the mean of many
  // scans.
  std::vector<RelativePose> step(KeyframeId id, const SE3& T_odom_body, const std::vector<Surfel>& surfels,
                                 const Matrix6d& anchor_covariance, int threads);

  // What comes is registered against nothing from before.
  void forget() { references_.clear(); }

  // All but the configuration; see StateArchive.
  void visitState(auto& archive) { archive(references_); }

 private:
  struct Reference {
    KeyframeId id;
    SE3 T_odom_body;
    Matrix6d anchor_covariance;
    SurfelMap map;

    void visitState(auto& archive) { archive(id, T_odom_body, anchor_covariance, map); }
  };
  RegistrationConfig registration_;
  CovarianceConfig covariance_;
  std::deque<Reference> references_;
};

}  // namespace sgraphs
