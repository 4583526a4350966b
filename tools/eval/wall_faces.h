#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/eval/mesh_query.h"
#include "tools/eval/truth.h"

namespace sgraphs {

// A place on a face and what is true there.
struct FaceSample {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  // along the face from `begin`, height z [m]
  bool exposed = false;                          // surface of the mesh: no doorway
  double seen_s = 0;  // how long the sensor had it in view; every second sample in both directions is tried
};

// One of the two long sides of a true wall, in the building's frame.
struct TrueFace {
  size_t wall = 0;                                  // index in Plan::walls
  Eigen::Vector2d begin = Eigen::Vector2d::Zero();  // the face looks to the left of begin -> end
  Eigen::Vector2d end = Eigen::Vector2d::Zero();
  std::vector<FaceSample> samples;  // row by row from below, `columns` in each
  size_t columns = 0;
  bool glass = false;         // never in view: a LiDAR looks through it
  double sample_area_m2 = 0;  // what one sample stands for
  double seen_s = 0;          // how long kSeenArea_m2 of it and more were in view at once

  // Of the samples, about.
  static constexpr double kSpacing_m = 0.2;
  // "Seen" asks for this much of the face at once: less is no wall to anybody.
  static constexpr double kSeenArea_m2 = 0.5;

  double length() const { return (end - begin).norm(); }
  Eigen::Vector2d along() const { return (end - begin).normalized(); }
  Eigen::Vector3d normal() const { return {-along().y(), along().x(), 0}; }
  // Signed distance, positive on the side the face looks to.
  double distance(const Eigen::Vector3d& p) const { return normal().head<2>().dot(p.head<2>() - begin); }
  Eigen::Vector2d onFace(const Eigen::Vector3d& p) const { return {along().dot(p.head<2>() - begin), p.z()}; }
  Eigen::Vector3d point(const Eigen::Vector2d& at) const {
    const Eigen::Vector2d p = begin + at.x() * along();
    return {p.x(), p.y(), at.y()};
  }
};

// Both sides of every wall of the plan, sampled; which samples are surface is asked of the mesh.
std::vector<TrueFace> trueFaces(const Plan& plan, const MeshQuery& mesh);

// Fills in how long each face was in view of a VLP-16 on the true path: within 20 m and +-15 deg of the
// sensor's equator, not flatter than 5 deg, nothing in between; looked at every half second.
void lookFromPath(const std::vector<StampedPose>& truth, const SE3& T_body_lidar, const MeshQuery& mesh,
                  std::vector<TrueFace>& faces);

}  // namespace sgraphs
