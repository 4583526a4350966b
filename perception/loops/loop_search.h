#pragma once

#include <optional>
#include <vector>

#include "perception/loops/loop_consistency.h"
#include "perception/loops/loop_verification.h"
#include "perception/loops/wall_layout.h"

namespace sgraphs {

// One way in which a keyframe's surroundings can be a known place.
struct LoopHypothesis {
  MeasuredLoop loop;
  LoopCheck check;
  double correction_m = 0;  // how far it moves the keyframe from where the map has it
  double gate_m = 0;        // how far it might
};

// Everything that a keyframe can be. One hypothesis: a return. Several: a place that looks like others.
struct LoopVerdict {
  KeyframeId keyframe;
  std::vector<LoopHypothesis> hypotheses;  // distinct poses, best first
  // The pose that the map has cannot be right: older places that it lies among contradict. Without that a
  // return that corrects much is not believed: an office that is entered for the first time looks like the
  // one next door.
  bool map_refuted = false;
  int registrations = 0;
};

// Looks for a remembered place of which this keyframe can be another look: the walls around are laid over the
// older walls within the gate, and what fits is verified.
class LoopSearch {
 public:
  explicit LoopSearch(const LoopsConfig& config) : config_(config) {}

  LoopVerdict step(KeyframeId keyframe, const PlaceMemory& memory, const WalkedPath& path) const;

  // What the keyframe would be on another floor, straight above or below where the map has it, at the height
  // at which the robot walked there; nothing if it never walked there.
  std::optional<LoopHypothesis> straightAcross(KeyframeId keyframe, FloorId floor, const PlaceMemory& memory,
                                               const WalkedPath& path) const;

 private:
  // A remembered place on the keyframe's storey, walked past long enough ago.
  struct OldPlace {
    KeyframeId id;
    const Place* place;
    SE3 T_map_body;
  };
  using OldPlaces = std::vector<OldPlace>;
  struct Anchor {
    KeyframeId id;
    SE3 T_map_body;
    LoopGate gate;
  };
  using Anchors = std::vector<Anchor>;
  OldPlaces oldPlaces(KeyframeId keyframe, const PlaceMemory& memory, const WalkedPath& path) const;
  Anchors anchorsOf(KeyframeId keyframe, const OldPlaces& old, const PlaceMemory& memory,
                    const WalkedPath& path) const;
  // What is seen from `guess.to` (the query), registered against the surroundings of `guess.from`.
  LoopHypothesis measured(const std::vector<PlacedPlace>& query, const OldSurroundings& around,
                          const MeasuredLoop& guess, const WalkedPath& path) const;
  OldSurroundings surroundingsOf(const Anchor& anchor, const OldPlaces& old, const WalkedPath& path) const;

  LoopsConfig config_;
};

}  // namespace sgraphs
