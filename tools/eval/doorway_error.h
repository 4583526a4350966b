#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/eval/graph_file.h"
#include "tools/eval/trajectory_error.h"
#include "tools/eval/truth.h"

namespace sgraphs {

struct DoorwayResult {
  std::string missing;  // why doorways were not judged; empty if they were. What is asked for is known anyway

  struct Truth {
    bool walked_through = false;
    bool of_asked_room = false;      // of a room that is asked for
    std::optional<size_t> estimate;  // index of estimates
    double distance_m = 0;           // to that, seen from above
    double width_error_m = 0;        // signed: of that
  };
  std::vector<Truth> truth;  // as Plan::doorways

  struct Estimate {
    std::string source, target;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // in the building's frame
    double width_m = 0;
    size_t storey = 0;
    bool is_true = false;
  };
  std::vector<Estimate> estimates;  // as the graph has them

  struct Count {
    size_t asked = 0, found = 0;
  };
  Count walked_through, of_asked_rooms, all;
  size_t num_false = 0;
  ErrorStatistics distance_m, width_error_m;  // absolute, over those found

  static constexpr double kMaxDistance_m = 0.5;
};

// Doorways of the graph, in map, against those of the plan, which must have storeys: one to one on each, the
// nearest first.
DoorwayResult judgeDoorways(const Plan& plan, const std::vector<StampedPose>& truth,
                            const EstimatedGraph& graph, const SE3& T_truth_map);

}  // namespace sgraphs
