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

}  // namespace
}  // namespace sgraphs
