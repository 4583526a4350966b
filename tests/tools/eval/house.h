#pragma once

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "common/io/text_file.h"
#include "common/io/tum.h"
#include "tools/eval/graph_file.h"
#include "tools/eval/truth.h"

namespace sgraphs::test {

inline Corners box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

// Two storeys, 3.2 m apart. Below: room R1, the L-shaped R2 beside it, corridor C_1 along both, and R4, which
// nobody enters. Above R1: U1. The body stands in R1 for 20 s, walks through doorway 0 into R2 (10 s),
// through doorway 2 into the corridor, up the stairs in it and into U1 (5 s), at 1 m/s.
struct House {
  Plan plan;
  std::vector<StampedPose> poses;

  static constexpr double kUpper_m = 3.2;
  static constexpr Time kStart{1'700'000'000'000'000};

  House() {
    plan.floors_z_m = {0, kUpper_m};
    plan.rooms = {{"R1", 0, box(0, 0, 4, 4)},
                  {"R2", 0, {{4.2, 0}, {8.2, 0}, {8.2, 2}, {6.2, 2}, {6.2, 4}, {4.2, 4}}},
                  {"C_1", 0, box(0, 4.2, 8.2, 6)},
                  {"R4", 0, box(10, 0, 14, 4)},
                  {"U1", 1, box(0, 0, 4, 4)}};
    plan.walls = {{{4.1, 0}, {4.1, 4}, 0.2, 0, 2.5}, {{0, 4.1}, {8.2, 4.1}, 0.2, 0, 2.5}};
    plan.doorways = {{0, {4.1, 1, 0}, 0.9},
                     {0, {2, 4.1, 0}, 0.9},
                     {0, {5.2, 4.1, 0}, 0.9},
                     {1, {2, 4.1, kUpper_m}, 1.0},
                     {0, {12, 4.1, 0}, 0.9}};
    stand({1, 1, 0.5}, 20);
    walkTo({5.2, 1, 0.5});
    stand({5.2, 1, 0.5}, 10);
    walkTo({5.2, 5, 0.5});
    walkTo({2, 5, kUpper_m + 0.5});
    walkTo({2, 2, kUpper_m + 0.5});
    stand({2, 2, kUpper_m + 0.5}, 5);
  }

  // The truth's rooms, floors and doorways as a graph in map has them.
  EstimatedGraph graph(const SE3& T_map_truth) const {
    EstimatedGraph graph;
    for (size_t s = 0; s < plan.floors_z_m.size(); ++s) {
      const Eigen::Vector3d p = T_map_truth * Eigen::Vector3d(3, 2, plan.floors_z_m[s]);
      graph.floors.push_back({"f" + std::to_string(s), p.head<2>(), p.z()});
    }
    for (const TrueRoom& room : plan.rooms) addRoom(graph, room.polygon, room.floor, T_map_truth);
    for (const TrueDoorway& doorway : plan.doorways)
      graph.doorways.push_back({doorway.floor ? "r4" : "r0", "p1", "f" + std::to_string(doorway.floor),
                                T_map_truth * doorway.position, doorway.width_m});
    return graph;
  }

  static void addRoom(EstimatedGraph& graph, const Corners& polygon, size_t floor, const SE3& T_map_truth) {
    EstimatedRoom room{
        "r" + std::to_string(graph.rooms.size()), "f" + std::to_string(floor), {}, std::nullopt};
    for (const Eigen::Vector2d& p : polygon)
      room.polygon.push_back((T_map_truth * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>());
    graph.rooms.push_back(room);
  }

 private:
  void stand(const Eigen::Vector3d& at, double seconds) {
    for (int i = 0; i < std::lround(100 * seconds); ++i) add(at);
  }
  void walkTo(const Eigen::Vector3d& to) {
    const Eigen::Vector3d from = poses.back().pose.translation;
    const auto steps = static_cast<int>(std::ceil((to - from).norm() / 0.01));
    for (int i = 1; i <= steps; ++i) add(from + (to - from) * i / steps);
  }
  void add(const Eigen::Vector3d& at) {
    poses.push_back({kStart + Duration{static_cast<int64_t>(poses.size()) * 10'000},
                     {Eigen::Quaterniond::Identity(), at}});
  }
};

// Upright, as a map is.
inline const SE3 kMapOfHouse(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ())),
                             {3, -8, 1.5});

inline std::string cornersText(const Corners& polygon) {
  std::string text;
  char corner[96];
  for (const Eigen::Vector2d& p : polygon) {
    std::snprintf(corner, sizeof corner, "%s[%.9f, %.9f]", text.empty() ? "" : ", ", p.x(), p.y());
    text += corner;
  }
  return "[" + text + "]";
}

inline std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9f", value);
  return text;
}

inline std::string xyzText(const Eigen::Vector3d& p) {
  return "[" + number(p.x()) + ", " + number(p.y()) + ", " + number(p.z()) + "]";
}

// graph.json with rooms, floors and doorways.
inline std::string graphText(const EstimatedGraph& graph) {
  std::string nodes, links;
  for (const EstimatedFloor& f : graph.floors)
    nodes += std::string(nodes.empty() ? "" : ",\n") + R"({"id": ")" + f.id +
             R"(", "layer": "floors", "center": [)" + number(f.center.x()) + ", " + number(f.center.y()) +
             R"(], "z": )" + (f.z_m ? number(*f.z_m) : std::string("null")) + "}";
  for (const EstimatedRoom& r : graph.rooms)
    nodes += std::string(nodes.empty() ? "" : ",\n") + R"({"id": ")" + r.id +
             R"(", "layer": "rooms", "kind": "polygon", "polygon": )" + cornersText(r.polygon) +
             R"(, "floor": ")" + r.floor + "\"" +
             (r.accepted ? R"(, "utime": )" + std::to_string(r.accepted->us) : std::string()) + "}";
  for (const EstimatedDoorway& d : graph.doorways)
    links += std::string(links.empty() ? "" : ",\n") + R"({"source": ")" + d.source + R"(", "target": ")" +
             d.target + R"(", "kind": "doorway", "xyz": )" + xyzText(d.position) + R"(, "width": )" +
             number(d.width_m) + "}";
  return R"({"schema": "sgraphs/1", "directed": false, "multigraph": true, "nodes": [)" + nodes +
         R"(], "links": [)" + links + "]}\n";
}

inline std::string planText(const Plan& plan) {
  std::string rooms, walls, doorways, floors;
  for (const double z_m : plan.floors_z_m) floors += (floors.empty() ? "" : ", ") + number(z_m);
  for (const TrueRoom& r : plan.rooms)
    rooms += std::string(rooms.empty() ? "" : ", ") + R"({"id": ")" + r.id + R"(", "floor": )" +
             std::to_string(r.floor) + R"(, "polygon": )" + cornersText(r.polygon) + "}";
  for (const TrueWall& w : plan.walls) {
    const std::string a = cornersText({w.a}), b = cornersText({w.b});
    walls += std::string(walls.empty() ? "" : ", ") + R"({"a": )" + a.substr(1, a.size() - 2) + R"(, "b": )" +
             b.substr(1, b.size() - 2) + R"(, "thickness": )" + number(w.thickness_m) + R"(, "z": [)" +
             number(w.z_low_m) + ", " + number(w.z_high_m) + "]" + (w.glass ? R"(, "glass": true})" : "}");
  }
  for (const TrueDoorway& d : plan.doorways)
    doorways += std::string(doorways.empty() ? "" : ", ") + R"({"floor": )" + std::to_string(d.floor) +
                R"(, "xyz": )" + xyzText(d.position) + R"(, "width": )" + number(d.width_m) + "}";
  return R"({"floors": [)" + floors + R"(], "rooms": [)" + rooms + R"(], "walls": [)" + walls +
         R"(], "doorways": [)" + doorways + "]}\n";
}

// The folders OUT, with trajectory.tum and graph.json, and the truth.
inline void writeHouse(const House& house, const EstimatedGraph& graph, const SE3& T_map_truth,
                       const std::string& out, const std::string& truth) {
  createFolder(out);
  createFolder(truth);
  std::vector<StampedPose> estimate;
  for (size_t i = 0; i < house.poses.size(); i += 10)
    estimate.push_back({house.poses[i].time, T_map_truth * house.poses[i].pose});
  writeTum(out + "/trajectory.tum", estimate);
  writeFile(out + "/graph.json", graphText(graph));
  writeTum(truth + "/gt.tum", house.poses);
  writeFile(truth + "/plan.json", planText(house.plan));
}

}  // namespace sgraphs::test
