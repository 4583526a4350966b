#include "tools/eval/graph_file.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "backend/output/graph_files.h"
#include "common/base/error.h"
#include "common/io/text_file.h"
#include "tests/backend/output/synthetic_planes.h"
#include "tests/support/temp_folder.h"

namespace sgraphs {
namespace {

struct Room {
  test::TempFolder folder;
  std::string path = folder / "graph.json";
  std::unique_ptr<test::SyntheticRun> run = test::makeSyntheticRun();

  Room() {
    test::addRoomPlanes(run->room, run->graph);
    writeFile(path, graphJson(run->graph, run->graph.floors, {{{1}, 2 * Matrix6d::Identity()}}));
  }
};

TEST(GraphFileTest, ReadsBackWhatARunWrote) {
  const Room room;
  const EstimatedGraph graph = readEstimatedGraph(room.path);
  ASSERT_EQ(graph.keyframes.size(), 14u);
  EXPECT_FALSE(graph.keyframes[0].covariance);
  EXPECT_EQ(*graph.keyframes[1].covariance, 2 * Matrix6d::Identity());
  EXPECT_EQ(graph.keyframes[5].T_map_body.translation,
            room.run->graph.keyframes.at({5}).T_map_body.translation);
  ASSERT_EQ(graph.walls.size(), 6u);
  const PlaneNode& plane = room.run->graph.planes.at({2});
  EXPECT_EQ(graph.walls[2].id, "w2");
  EXPECT_TRUE(graph.walls[2].vertical());
  EXPECT_FALSE(graph.walls[5].vertical());
  EXPECT_EQ(graph.walls[2].normal, plane.normal_map);
  EXPECT_EQ(graph.walls[2].covariance, plane.covariance);
  EXPECT_EQ(graph.walls[2].polygon, plane.polygon_map);
}

TEST(GraphFileTest, OfAContinuedMapTheLastSessionsKeyframesAreRead) {
  Room room;
  const Time begin = room.run->graph.keyframes.at({10}).time;
  const std::vector<SessionClock> sessions = {{{0}, {0}, {}}, {{10}, begin, {7'000'000}}};
  writeFile(room.path,
            graphJson(room.run->graph, room.run->graph.floors, {{{11}, Matrix6d::Identity()}}, sessions));
  const EstimatedGraph graph = readEstimatedGraph(room.path);
  ASSERT_EQ(graph.keyframes.size(), 4u);
  EXPECT_EQ(graph.keyframes[0].time.us, begin.us - 7'000'000);
  EXPECT_FALSE(graph.keyframes[1].covariance) << "it is given a keyframe that the truth does not know";
  EXPECT_EQ(graph.walls.size(), 6u);
}

TEST(GraphFileTest, WhatIsWrongIsNamedWithTheFile) {
  const Room room;
  const auto good = nlohmann::json::parse(readFile(room.path));
  const auto errorOf = [&](const nlohmann::json& json) -> std::string {
    writeFile(room.path, json.dump());
    try {
      readEstimatedGraph(room.path);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(errorOf(good), "no error");
  auto bad = good;
  bad["nodes"][14]["normal"] = {1, 1, 0};
  EXPECT_THAT(errorOf(bad), testing::AllOf(testing::HasSubstr(room.path), testing::HasSubstr("w0"),
                                           testing::HasSubstr("no unit vector")));
  bad = good;
  bad["nodes"][14]["covariance"][0] = -1;
  EXPECT_THAT(errorOf(bad), testing::HasSubstr("not positive"));
  bad = good;
  bad["nodes"][14]["polygon"] = nlohmann::json::array();
  EXPECT_THAT(errorOf(bad), testing::HasSubstr("less than three corners"));
  bad = good;
  bad["nodes"][14].erase("axes");
  EXPECT_THAT(errorOf(bad), testing::HasSubstr(room.path));
}

TEST(GraphFileTest, RoomsFloorsAndDoorwaysAreRead) {
  const test::TempFolder folder;
  const std::string path = folder / "graph.json";
  writeFile(path, R"({"nodes": [
    {"id": "r0", "layer": "rooms", "kind": "polygon", "polygon": [[0, 0], [2, 0], [2, 3]], "floor": "f1", "utime": 7},
    {"id": "r1", "layer": "rooms", "kind": "finite", "polygon": null},
    {"id": "p4", "layer": "free_space", "xyz": [0, 0, 0], "clearance": 1, "cluster": 2},
    {"id": "f1", "layer": "floors", "center": [4, 5], "z": -0.5},
    {"id": "f2", "layer": "floors", "center": [4, 5], "z": null}],
   "links": [{"source": "p4", "target": "r0", "kind": "doorway", "xyz": [1, 2, 3], "width": 0.9},
             {"source": "p4", "target": "r0", "kind": "free_space"}]})");
  const EstimatedGraph graph = readEstimatedGraph(path);
  ASSERT_EQ(graph.rooms.size(), 2u);
  EXPECT_EQ(graph.rooms[0].polygon[2], Eigen::Vector2d(2, 3));
  EXPECT_EQ(graph.rooms[0].floor, "f1");
  EXPECT_EQ(graph.rooms[0].accepted->us, 7);
  EXPECT_TRUE(graph.rooms[1].polygon.empty());
  EXPECT_FALSE(graph.rooms[1].accepted);
  ASSERT_EQ(graph.floors.size(), 2u);
  EXPECT_EQ(*graph.floors[0].z_m, -0.5);
  EXPECT_FALSE(graph.floors[1].z_m);
  ASSERT_EQ(graph.doorways.size(), 1u);
  EXPECT_EQ(graph.doorways[0].floor, "f1");  // the cluster has none
  EXPECT_EQ(graph.doorways[0].width_m, 0.9);
}

}  // namespace
}  // namespace sgraphs
