#pragma once

#include <vector>

#include "perception/loops/place.h"
#include "perception/odometry/registration.h"

namespace sgraphs {

// Old places about one of them, the anchor, merged into one cloud by their present poses.
class OldSurroundings {
 public:
  // Poses in the anchor's body.
  explicit OldSurroundings(std::vector<PlacedPlace> places_anchor);
  // Of as many of them, the nearest, as a registration needs.
  static OldSurroundings ofNearest(std::vector<PlacedPlace> places_anchor);

  const std::vector<PlacedPlace>& places() const { return places_; }
  const SurfelMap& map() const { return map_; }

 private:
  std::vector<PlacedPlace> places_;
  SurfelMap map_;
};

// Whether two poses are two answers and not one: by place, or by heading (10 degrees).
inline constexpr double kDistinct_m = 0.5;
bool areDistinct(const SE3& a, const SE3& b);

// How well a newer look at a place agrees with the older one, at the pose that fits best.
struct LoopCheck {
  SE3 T_anchor_body;
  Matrix6d covariance = Matrix6d::Identity();  // of the right perturbation
  double overlap = 0;         // share of the newer cloud that the older surroundings can show
  double inlier_share = 0;    // of what one side should see of the other, what it sees
  double conflict_share = 0;  // of the same, what stands where the other saw through
  double fit_share = 0;       // of the newer patches, what meets the old surfaces within the noise
  int seen = 0;               // patches that the two shares are made of
  double sigma_m = 0;         // standard deviation of the worst direction
  double sigma_rad = 0;

  // Looks like the same place; whether its pose is known is another question.
  bool alike(const LoopVerificationConfig& config) const;
  // Its pose is known in all directions: no bare corridor.
  bool fixed(const LoopVerificationConfig& config) const;
  // Cannot be the place: too much stands where the other saw through.
  bool refuted(const LoopVerificationConfig& config) const;
  // Of two places that the newer look may show: which it shows rather.
  double quality() const { return inlier_share - 2.0 * conflict_share + 0.25 * fit_share; }
};

// Registers the newer look against the old surroundings from a guess and compares what both saw through.
// `query`: the newest keyframe first, then those before it, with poses in its body.
LoopCheck checkLoop(const std::vector<PlacedPlace>& query, const OldSurroundings& old,
                    const SE3& T_anchor_body_guess, const LoopVerificationConfig& config);

}  // namespace sgraphs
