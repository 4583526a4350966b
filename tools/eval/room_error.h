#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/eval/graph_file.h"
#include "tools/eval/path_in_plan.h"
#include "tools/eval/trajectory_error.h"

namespace sgraphs {

struct RoomResult {
  std::string missing;  // why rooms were not judged; empty if they were. What is asked for is known anyway

  struct Truth {
    std::string id;
    RoomVisit visit;
    bool asked = false;
    std::optional<size_t> estimate;     // index of estimates
    double iou = 0;                     // with that
    double area_error_m2 = 0;           // signed: of that
    std::optional<double> detection_s;  // from the first second inside until that was accepted, at least 0
  };
  std::vector<Truth> truth;  // as Plan::rooms

  struct Estimate {
    std::string id;
    Corners polygon;  // in the building's frame
    size_t storey = 0;
    std::string why_false;  // empty if it is not
  };
  std::vector<Estimate> estimates;  // as the graph has them

  size_t num_asked = 0;
  size_t num_found = 0;  // of those asked for
  size_t num_true = 0;   // reported rooms that are one, corridors left out
  size_t num_false = 0;
  double mean_iou = 0;            // over those found
  ErrorStatistics area_error_m2;  // absolute, over those found
  // Over rooms found that the path was inside of for kLongVisit_s; none if the graph does not say when.
  std::optional<ErrorStatistics> detection_s;
  size_t num_long_visits = 0;  // rooms asked for that the path was inside of for so long

  static constexpr double kMinIou = 0.5;
  static constexpr double kLongVisit_s = 15;
};

// Rooms of the graph, in map, against those of the plan, which must have storeys: contract.md.
RoomResult judgeRooms(const Plan& plan, const std::vector<StampedPose>& truth, const EstimatedGraph& graph,
                      const SE3& T_truth_map);

}  // namespace sgraphs
