#pragma once

#include <cstdio>
#include <filesystem>

#include "common/io/text_file.h"
#include "tests/backend/output/synthetic_run.h"
#include "tests/tools/eval/truth_fixture.h"

namespace sgraphs::test {

// Truth of the synthetic run, in a building whose frame is not map.
inline const SE3 kT_building_map(Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ())),
                                 {20, 30, 0.5});

// The room's four sides as walls without thickness, in the building's frame, which is turned and moved
// against map.
inline std::string wallsJson(const BoxRoom& room) {
  const Eigen::Vector2d corners[] = {{room.min.x(), room.min.y()},
                                     {room.max.x(), room.min.y()},
                                     {room.max.x(), room.max.y()},
                                     {room.min.x(), room.max.y()}};
  std::string text;
  const auto at = [&](int i) {
    return kT_building_map * Eigen::Vector3d(corners[i % 4].x(), corners[i % 4].y(), room.min.z());
  };
  for (int i = 0; i < 4; ++i) {
    char wall[256];
    std::snprintf(wall, sizeof wall,
                  R"(%s{"a": [%.9f, %.9f], "b": [%.9f, %.9f], "thickness": 0, "z": [%.9f, %.9f]})",
                  i ? ", " : "", at(i).x(), at(i).y(), at(i + 1).x(), at(i + 1).y(), at(i).z(),
                  at(i).z() + room.max.z() - room.min.z());
    text += wall;
  }
  return "[" + text + "]";
}

inline TriangleMesh meshOf(const BoxRoom& room) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p((corner & 1 ? room.max : room.min).x(), (corner & 2 ? room.max : room.min).y(),
                            (corner & 4 ? room.max : room.min).z());
    mesh.vertices.push_back(kT_building_map * p);
  }
  for (const auto& [a, b, c, d] : {std::array{0, 1, 3, 2}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                                   std::array{2, 3, 7, 6}, std::array{0, 2, 6, 4}, std::array{1, 3, 7, 5}}) {
    mesh.triangles.emplace_back(a, b, c);
    mesh.triangles.emplace_back(a, c, d);
  }
  return mesh;
}

inline void writeTruth(const BoxRoom& room, const std::string& folder) {
  std::filesystem::remove_all(folder);
  createFolder(folder);
  std::vector<StampedPose> poses;
  poses.reserve(1400);
  for (int i = 0; i < 1400; ++i)
    poses.push_back({{1'700'000'000'000'000 + i * 10'000}, kT_building_map * squarePath(0.01 * i)});
  writeTum(folder + "/gt.tum", poses);
  writePlyMesh(folder + "/mesh.ply", meshOf(room));
  // One room around the path, one elsewhere, and a corridor around both.
  writeFile(
      folder + "/plan.json", R"({"floors": [0], "T_body_lidar": {"xyz": [0.1, 0, 0.3], "qxyzw": [0, 0, 0, 1]},
    "walls": )" + wallsJson(room) +
                                 R"(, "doorways": [],
    "rooms": [{"id": "R1", "floor": 0, "polygon": [[10, 20], [40, 20], [40, 50], [10, 50]]},
              {"id": "R2", "floor": 0, "polygon": [[110, 20], [140, 20], [140, 50], [110, 50]]},
              {"id": "C_1", "floor": 0, "polygon": [[0, 0], [140, 0], [140, 50], [0, 50]]}]})");
}

}  // namespace sgraphs::test
