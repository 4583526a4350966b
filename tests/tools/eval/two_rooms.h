#pragma once

#include <vector>

#include "common/geometry/tangent_basis.h"
#include "tools/eval/wall_error.h"

namespace sgraphs::test {

// Two rooms side by side, 8 m by 4 m and 2.5 m high, walls 10 cm thick: south, east, north, west, and a
// partition at x = 4 m with a doorway from y = 1.5 to 2.5 m. A cupboard stands in the left room.
struct TwoRooms {
  Plan plan;
  TriangleMesh mesh;

  TwoRooms() {
    const Eigen::Vector2d corners[] = {{0, 0}, {8, 0}, {8, 4}, {0, 4}};
    for (int i = 0; i < 4; ++i) plan.walls.push_back({corners[i], corners[(i + 1) % 4], 0.1, 0, 2.5});
    plan.walls.push_back({{4, 0}, {4, 4}, 0.1, 0, 2.5});
    plan.T_body_lidar.translation = {0, 0, 0.5};
    addBox({-0.05, -0.05, 0}, {8.05, 0.05, 2.5});
    addBox({7.95, -0.05, 0}, {8.05, 4.05, 2.5});
    addBox({-0.05, 3.95, 0}, {8.05, 4.05, 2.5});
    addBox({-0.05, -0.05, 0}, {0.05, 4.05, 2.5});
    addBox({3.95, 0, 0}, {4.05, 1.5, 2.5});
    addBox({3.95, 2.5, 0}, {4.05, 4, 2.5});
    addBox({0.2, 3.0, 0}, {0.7, 3.8, 1.8});
  }

  // Faces in the order of trueFaces: the left side of each wall first, which is the inner one here.
  static constexpr size_t kSouth = 0, kEast = 2, kNorth = 4, kWest = 6;
  static constexpr size_t kPartitionWest = 8, kPartitionEast = 9;

  // At rest in the left room, 10 Hz.
  static std::vector<StampedPose> standing(double duration_s, const Eigen::Vector3d& at = {2, 0.8, 0.5}) {
    std::vector<StampedPose> poses;
    for (int i = 0; 0.1 * i <= duration_s + 1e-9; ++i)
      poses.push_back({{1'000'000 + i * 100'000}, {Eigen::Quaterniond::Identity(), at}});
    return poses;
  }

  // What a perfect map says of the face from `from_m` to `to_m` along it, between two heights.
  static EstimatedWall estimateOf(const TrueFace& face, double from_m, double to_m, double low_m = 0.1,
                                  double high_m = 2.4) {
    EstimatedWall wall;
    wall.id = "w";
    wall.label = "x";
    wall.normal = face.normal();
    wall.centroid = face.point({0.5 * (from_m + to_m), 0.5 * (low_m + high_m)});
    const TangentBasis basis = tangentBasis(wall.normal);
    wall.axis_u = basis.col(1);
    wall.axis_v = -basis.col(0);
    for (const Eigen::Vector2d& at :
         {Eigen::Vector2d(from_m, low_m), {to_m, low_m}, {to_m, high_m}, {from_m, high_m}})
      wall.polygon.push_back(face.point(at));
    return wall;
  }
  static EstimatedWall wholeOf(const TrueFace& face) { return estimateOf(face, 0.1, face.length() - 0.1); }

 private:
  void addBox(const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
    const int first = static_cast<int>(mesh.vertices.size());
    for (int corner = 0; corner < 8; ++corner)
      mesh.vertices.emplace_back((corner & 1 ? max : min).x(), (corner & 2 ? max : min).y(),
                                 (corner & 4 ? max : min).z());
    for (const auto& [a, b, c, d] :
         {std::array{0, 1, 3, 2}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4}, std::array{2, 3, 7, 6},
          std::array{0, 2, 6, 4}, std::array{1, 3, 7, 5}}) {
      mesh.triangles.emplace_back(first + a, first + b, first + c);
      mesh.triangles.emplace_back(first + a, first + c, first + d);
    }
  }
};

inline EstimatedWall shifted(const EstimatedWall& wall, double offset_m) {
  return moved(wall, {Eigen::Quaterniond::Identity(), offset_m * wall.normal});
}

// Turned about the upright line through its centroid.
inline EstimatedWall turned(const EstimatedWall& wall, double angle_rad) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
  return moved(wall, {q, wall.centroid - q * wall.centroid});
}

}  // namespace sgraphs::test
