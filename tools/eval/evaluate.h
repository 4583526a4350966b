#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/eval/calibration.h"
#include "tools/eval/doorway_error.h"
#include "tools/eval/estimate_calibration.h"
#include "tools/eval/floor_error.h"
#include "tools/eval/loop_error.h"
#include "tools/eval/map_error.h"
#include "tools/eval/room_error.h"
#include "tools/eval/trajectory_error.h"
#include "tools/eval/truth.h"
#include "tools/eval/wall_error.h"

namespace sgraphs {

// How one of OUT's trajectories does; everything but `file` and `missing` is void if it is missing.
struct TrajectoryResult {
  std::string file;
  std::string missing;  // why it was not judged; empty if it was
  std::vector<StampedPose> poses;
  AbsoluteError absolute;
  std::optional<ErrorStatistics> nearest_stamp_m;  // evo's
  std::optional<RelativeError> per_metre;
  std::optional<RelativeError> per_second;
  double time_coverage = 0;
};

struct MapResult {
  std::string missing;  // why it was not judged; empty if it was
  std::vector<Eigen::Vector3d> points_truth;
  MapError error;

  // contract.md: a map RMSE counts only with this completeness.
  static constexpr double kMinCompleteness = 0.90;
  bool counts() const { return error.completeness >= kMinCompleteness; }
};

struct Evaluation {
  std::vector<TrajectoryResult> trajectories;  // the first one's alignment moves everything else
  MapResult map;
  std::map<std::string, Calibration> calibration;
  std::string calibration_missing;
  LoopResult loops;
  WallResult walls;
  EstimateCalibration estimates;
  RoomResult rooms;
  FloorResult floors;
  DoorwayResult doorways;
  std::vector<StoreyError> by_storey;  // of the first trajectory; empty if the path is on one storey only
};

// Judges the folder OUT. Throws Error if it holds no trajectory.tum or a file of it cannot be read.
Evaluation evaluate(const std::string& out_dir, const Truth& truth);

}  // namespace sgraphs
