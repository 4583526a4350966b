#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/eval/graph_file.h"
#include "tools/eval/trajectory_error.h"
#include "tools/eval/truth.h"

namespace sgraphs {

// Share of things asked for that were found, and of things reported that are true; none of none is nothing to
// judge by.
std::optional<double> shareOf(size_t part, size_t whole);

struct FloorResult {
  std::string missing;  // why floors were not judged; empty if they were

  struct Storey {
    double z_m = 0;
    double walked_s = 0;                   // of the path
    std::optional<size_t> estimate;        // index of estimates
    std::optional<double> height_error_m;  // signed: of the estimate; none if that has no height
  };
  std::vector<Storey> storeys;  // as Plan::floors_z_m

  struct Estimate {
    std::string id;
    std::optional<double> z_m;  // in the building's frame
    std::string why_false;      // empty if it is not
  };
  size_t by_lift = 0;               // levels whose height nothing measures: they were moved to where they are
  std::vector<Estimate> estimates;  // as the graph has them

  // A storey that the path is on for so long is asked for.
  static constexpr double kAskedAfter_s = 1.0;
  static constexpr double kMaxHeightError_m = 0.3;
  bool asked(size_t storey) const { return storeys[storey].walked_s >= kAskedAfter_s; }
  size_t numAsked() const;
  size_t numFound() const;  // of those asked for
  size_t numFalse() const;
};

// `floors` in map. One to one, nearest heights first; those without a height go to what is left, in order.
FloorResult judgeFloors(const Plan& plan, const std::vector<StampedPose>& truth,
                        const std::vector<EstimatedFloor>& floors, const SE3& T_truth_map);

// The storey that something on this floor of the graph belongs to: the nearest in height; without a height
// the lowest. The plan must have storeys.
size_t storeyOf(const std::string& floor_id, const std::vector<EstimatedFloor>& floors, const Plan& plan,
                const SE3& T_truth_map);

// Height of the floor in the building's frame.
std::optional<double> heightOf(const EstimatedFloor& floor, const SE3& T_truth_map);

// Absolute error of the poses whose true height is on one storey, or on none: on stairs.
struct StoreyError {
  std::optional<size_t> storey;
  ErrorStatistics translation_m;
};

// In the order of the storeys, stairs last; those without a pose are left out.
std::vector<StoreyError> errorByStorey(const Plan& plan, const std::vector<StampedPose>& truth,
                                       const AbsoluteError& error);

}  // namespace sgraphs
