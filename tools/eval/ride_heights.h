#pragma once

#include <utility>
#include <vector>

#include "common/io/tum.h"
#include "tools/eval/graph_file.h"

namespace sgraphs {

// The floors to which lifts have led: nothing measures how high they lie (graph.json says so), and an
// estimate puts them anywhere, far from the others. To judge all the rest of a run that says so, each of its
// levels is moved along the vertical to where it truly is.
class RideHeights {
 public:
  // A trajectory whose height jumps where rides end. Levels that overlap are one.
  RideHeights(const std::vector<StampedPose>& estimate, const std::vector<StampedPose>& truth);

  // What is at this height of the estimate belongs higher by so much [m].
  double shiftAt(double z_m) const;
  size_t levels() const { return levels_.size(); }

  // From when the car leaves to when the door opens: where the robot is then no estimate can know, and none
  // is judged.
  bool riding(Time time) const;

  void correct(std::vector<StampedPose>& poses) const;
  void correct(EstimatedGraph& graph) const;

 private:
  void findLevels(const std::vector<StampedPose>& estimate, const std::vector<StampedPose>& truth);
  void findRides(const std::vector<StampedPose>& estimate, const std::vector<StampedPose>& truth);

  struct Level {
    double z_min_m, z_max_m;
    double shift_m;
  };
  std::vector<Level> levels_;
  std::vector<std::pair<Time, Time>> rides_;
};

}  // namespace sgraphs
