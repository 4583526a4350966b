#include "tools/eval/estimate_calibration.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>

namespace sgraphs {
namespace {

template <typename Vector, typename Matrix>
double nees(const Vector& error, const Matrix& covariance) {
  return error.dot(covariance.ldlt().solve(error));
}

void judgePoses(const EstimatedGraph& graph, const std::vector<StampedPose>& truth, const SE3& T_truth_first,
                EstimateCalibration& result) {
  std::vector<double> whole, translation, rotation;
  const SE3 T_first_map = graph.keyframes.front().T_map_body.inverse();
  for (size_t k = 1; k < graph.keyframes.size(); ++k) {
    const EstimatedKeyframe& keyframe = graph.keyframes[k];
    const auto T_truth_body = poseAt(truth, keyframe.time);
    if (!T_truth_body || !keyframe.covariance) continue;
    const Matrix6d& covariance = *keyframe.covariance;
    const Vector6d error =
        se3Log((T_first_map * keyframe.T_map_body).inverse() * (T_truth_first.inverse() * *T_truth_body));
    whole.push_back(nees(error, covariance));
    translation.push_back(
        nees(Eigen::Vector3d(error.head<3>()), Eigen::Matrix3d(covariance.topLeftCorner<3, 3>())));
    rotation.push_back(
        nees(Eigen::Vector3d(error.tail<3>()), Eigen::Matrix3d(covariance.bottomRightCorner<3, 3>())));
  }
  result.pose = neesStatistics(6, std::move(whole));
  result.pose_translation = neesStatistics(3, std::move(translation));
  result.pose_rotation = neesStatistics(3, std::move(rotation));
}

// The true plane from the estimate: turns about its axes, and its distance along the normal at the centroid.
Eigen::Vector3d errorOf(const EstimatedWall& wall, const TrueFace& face) {
  const Eigen::Vector3d n_true = face.normal();
  // A small turn about axis a moves the normal n by a x n.
  const double tilt_u = wall.axis_u.cross(wall.normal).dot(n_true);
  const double tilt_v = wall.axis_v.cross(wall.normal).dot(n_true);
  return {tilt_u, tilt_v, -face.distance(wall.centroid) / n_true.dot(wall.normal)};
}

// Of the faces a wall lies on, the one it covers most.
std::vector<const WallMatch*> bestMatches(const WallResult& judged) {
  std::vector<const WallMatch*> best(judged.walls.size(), nullptr);
  for (const WallMatch& match : judged.matches)
    if (!best[match.wall] || match.claimed.size() > best[match.wall]->claimed.size())
      best[match.wall] = &match;
  return best;
}

void judgePlanes(const EstimatedGraph& graph, const SE3& T_truth_map, const WallResult& judged,
                 EstimateCalibration& result) {
  if (!judged.missing.empty()) return;
  std::vector<double> tilts, offsets;
  const auto best = bestMatches(judged);
  size_t vertical = 0;
  for (const EstimatedWall& wall : graph.walls) {
    if (!wall.vertical()) continue;
    const WallMatch* match = best[vertical++];
    if (!match) continue;
    const Eigen::Vector3d error = errorOf(moved(wall, T_truth_map), judged.faces[match->face]);
    tilts.push_back(
        nees(Eigen::Vector2d(error.head<2>()), Eigen::Matrix2d(wall.covariance.topLeftCorner<2, 2>())));
    offsets.push_back(error.z() * error.z() / wall.covariance(2, 2));
  }
  result.plane_tilt = neesStatistics(2, std::move(tilts));
  result.plane_offset = neesStatistics(1, std::move(offsets));
}

}  // namespace

NeesStatistics neesStatistics(int dof, std::vector<double> values) {
  NeesStatistics result;
  result.dof = dof;
  result.count = values.size();
  if (values.empty()) return result;
  for (const double value : values) result.mean += value / static_cast<double>(values.size());
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  result.median = values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  return result;
}

EstimateCalibration calibrationOfEstimates(const EstimatedGraph& graph, const std::vector<StampedPose>& truth,
                                           const WallResult& judged) {
  EstimateCalibration result;
  if (graph.keyframes.empty()) return result;
  const auto T_truth_first = poseAt(truth, graph.keyframes.front().time);
  if (!T_truth_first) return result;
  judgePoses(graph, truth, *T_truth_first, result);
  judgePlanes(graph, *T_truth_first * graph.keyframes.front().T_map_body.inverse(), judged, result);
  return result;
}

}  // namespace sgraphs
