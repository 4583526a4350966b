#pragma once

#include <vector>

#include "tools/eval/graph_file.h"
#include "tools/eval/wall_error.h"

namespace sgraphs {

// Normalised estimation errors squared of one kind; their mean is `dof` and their median that of a chi-square
// if the covariances are what they claim to be.
struct NeesStatistics {
  int dof = 0;
  size_t count = 0;
  double mean = 0;
  double median = 0;
};

NeesStatistics neesStatistics(int dof, std::vector<double> values);

// Optimised estimates in the frame of the first keyframe, which the graph holds fixed: no alignment of whole
// trajectories takes part.
struct EstimateCalibration {
  NeesStatistics pose, pose_translation, pose_rotation;  // keyframes but the first
  NeesStatistics plane_tilt, plane_offset;               // walls that lie on a true face
};

// `walls` in map, as the graph has them; `judged` says which of them lie on which true face. All counts are 0
// if the truth does not reach the first keyframe.
EstimateCalibration calibrationOfEstimates(const EstimatedGraph& graph, const std::vector<StampedPose>& truth,
                                           const WallResult& judged);

}  // namespace sgraphs
