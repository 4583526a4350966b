#include "tools/eval/wall_faces.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

constexpr double kExposedWithin_m = 0.01;
constexpr double kRange_m = 20;
constexpr double kMaxElevation_rad = 15 * M_PI / 180;  // of a VLP-16's lasers
constexpr double kMinIncidence_rad = 5 * M_PI / 180;   // flatter rays return nothing
constexpr double kFaceSightMargin_m = 0.01;
constexpr Duration kLookEvery{500'000};
constexpr size_t kStride = 2;  // of the samples that are looked at, in both directions
constexpr double kMinLength_m = 0.05;

size_t numSamples(double extent_m) {
  return static_cast<size_t>(std::max(1.0, std::round(extent_m / TrueFace::kSpacing_m)));
}

TrueFace faceOf(const Plan& plan, size_t index, bool left, const MeshQuery& mesh) {
  const TrueWall& wall = plan.walls[index];
  TrueFace face;
  face.wall = index;
  face.glass = wall.glass;
  const Eigen::Vector2d along = (wall.b - wall.a).normalized();
  const Eigen::Vector2d shift = 0.5 * wall.thickness_m * Eigen::Vector2d(-along.y(), along.x());
  face.begin = left ? Eigen::Vector2d(wall.a + shift) : Eigen::Vector2d(wall.b - shift);
  face.end = left ? Eigen::Vector2d(wall.b + shift) : Eigen::Vector2d(wall.a - shift);
  face.columns = numSamples(face.length());
  const size_t rows = numSamples(wall.z_high_m - wall.z_low_m);
  face.sample_area_m2 =
      face.length() * (wall.z_high_m - wall.z_low_m) / static_cast<double>(rows * face.columns);
  for (size_t row = 0; row < rows; ++row)
    for (size_t column = 0; column < face.columns; ++column) {
      const double s = (static_cast<double>(column) + 0.5) / static_cast<double>(face.columns);
      const double t = (static_cast<double>(row) + 0.5) / static_cast<double>(rows);
      FaceSample sample{{s * face.length(), wall.z_low_m + t * (wall.z_high_m - wall.z_low_m)}, false, 0};
      // Whether the mesh holds panes is not said: on a pane every place is one that may be found.
      sample.exposed = wall.glass || mesh.distance(face.point(sample.at), kExposedWithin_m).has_value();
      face.samples.push_back(sample);
    }
  return face;
}

bool inView(const SE3& T_truth_lidar, const TrueFace& face, const Eigen::Vector3d& point,
            const MeshQuery& mesh) {
  const Eigen::Vector3d ray = point - T_truth_lidar.translation;
  const double range = ray.norm();
  if (range > kRange_m || range < 1e-3) return false;
  if (-face.normal().dot(ray) < std::sin(kMinIncidence_rad) * range) return false;
  const Eigen::Vector3d ray_lidar = T_truth_lidar.rotation.conjugate() * ray;
  if (std::abs(ray_lidar.z()) > std::sin(kMaxElevation_rad) * range) return false;
  return !mesh.occluded(T_truth_lidar.translation, point, kFaceSightMargin_m);
}

void look(const SE3& T_truth_lidar, double duration_s, const MeshQuery& mesh, TrueFace& face) {
  if (face.glass || face.distance(T_truth_lidar.translation) <= 0) return;
  const double tried_m2 = kStride * kStride * face.sample_area_m2;  // one sample in so many is looked at
  double seen_m2 = 0;
  for (size_t row = 0; row < face.samples.size(); row += kStride * face.columns)
    for (size_t column = 0; column < face.columns; column += kStride) {
      FaceSample& sample = face.samples[row + column];
      if (!sample.exposed || !inView(T_truth_lidar, face, face.point(sample.at), mesh)) continue;
      sample.seen_s += duration_s;
      seen_m2 += tried_m2;
    }
  if (seen_m2 >= TrueFace::kSeenArea_m2) face.seen_s += duration_s;
}

}  // namespace

std::vector<TrueFace> trueFaces(const Plan& plan, const MeshQuery& mesh) {
  std::vector<TrueFace> faces;
  for (size_t i = 0; i < plan.walls.size(); ++i) {
    const TrueWall& wall = plan.walls[i];
    if ((wall.b - wall.a).norm() < kMinLength_m || wall.z_high_m <= wall.z_low_m) continue;
    for (const bool left : {true, false}) faces.push_back(faceOf(plan, i, left, mesh));
  }
  return faces;
}

void lookFromPath(const std::vector<StampedPose>& truth, const SE3& T_body_lidar, const MeshQuery& mesh,
                  std::vector<TrueFace>& faces) {
  std::vector<std::pair<SE3, double>> looks;  // from where, for how long
  for (size_t i = 0; i < truth.size();) {
    size_t next = i + 1;
    while (next < truth.size() && truth[next].time - truth[i].time < kLookEvery) ++next;
    if (next == truth.size()) break;
    // A gap of the truth counts as one look.
    const double duration_s =
        std::min((truth[next].time - truth[i].time).seconds(), 2 * kLookEvery.seconds());
    looks.emplace_back(truth[i].pose * T_body_lidar, duration_s);
    i = next;
  }
  tbb::parallel_for(size_t{0}, faces.size(), [&](size_t f) {
    for (const auto& [T_truth_lidar, duration_s] : looks) look(T_truth_lidar, duration_s, mesh, faces[f]);
  });
}

}  // namespace sgraphs
