#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/io/tum.h"

namespace sgraphs {

// Truth at an instant, along a constant twist between its rows; none outside its time.
std::optional<SE3> poseAt(const std::vector<StampedPose>& trajectory, Time time);

// Rotation and translation, no scale, that bring `from` onto `to` with least squared distances (Umeyama
// 1991). Needs as many points in both; throws Error if they lie on one line or there are fewer than three.
SE3 alignPoints(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to);

struct ErrorStatistics {
  size_t count = 0;
  double rmse = 0;
  double median = 0;
  double max = 0;
};

ErrorStatistics statisticsOf(std::vector<double> errors);

// Absolute trajectory error: translation after SE(3) alignment.
struct AbsoluteError {
  SE3 T_truth_map;  // the alignment
  ErrorStatistics translation_m;
  std::vector<std::pair<Time, double>> over_time;  // [m]
};

// Truth interpolated at every stamp of the estimate that lies within the truth's time. Throws Error if fewer
// than three do.
AbsoluteError absoluteError(const std::vector<StampedPose>& truth, const std::vector<StampedPose>& estimate);

// As `evo_ape tum TRUTH ESTIMATE -a` computes it: each pose of the shorter trajectory with the nearest stamp
// of the longer, at most 0.01 s apart. None where evo finds fewer than three pairs or no alignment.
std::optional<ErrorStatistics> absoluteErrorNearestStamp(const std::vector<StampedPose>& truth,
                                                         const std::vector<StampedPose>& estimate);

// Relative pose error over pairs of the estimate's poses.
struct RelativeError {
  ErrorStatistics translation_m;
  ErrorStatistics rotation_rad;
};

// From each pose to the first one at least this far along the truth's path, or this much later; pairs that
// overshoot by more than a quarter are left out, none if there are no pairs.
std::optional<RelativeError> relativeErrorPerPath(const std::vector<StampedPose>& truth,
                                                  const std::vector<StampedPose>& estimate, double path_m);
std::optional<RelativeError> relativeErrorPerTime(const std::vector<StampedPose>& truth,
                                                  const std::vector<StampedPose>& estimate,
                                                  Duration duration);

// Share of the truth's time that lies between consecutive stamps of the estimate at most `max_gap` apart.
double timeCoverage(const std::vector<StampedPose>& truth, const std::vector<StampedPose>& estimate,
                    Duration max_gap);

}  // namespace sgraphs
