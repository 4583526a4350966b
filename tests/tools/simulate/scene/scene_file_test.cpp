#include "tools/simulate/scene/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "tools/simulate/building/building.h"
#include "tools/simulate/scene/find_scene.h"

namespace sgraphs::simulate {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

json goodPlan() {
  return json::parse(R"({
    "T_body_lidar": {"xyz": [0.1, 0, 0.3], "qxyzw": [0, 0, 0, 1]},
    "floors": [0.0],
    "rooms": [{"id": "R1", "floor": 0, "polygon": [[0.05, 0.05], [5.95, 0.05], [5.95, 3.95], [0.05, 3.95]]}],
    "walls": [{"a": [0, 0], "b": [6, 0], "thickness": 0.1, "z": [0, 2.5]},
              {"a": [6, 0], "b": [6, 4], "thickness": 0.1, "z": [0, 2.5]},
              {"a": [6, 4], "b": [0, 4], "thickness": 0.1, "z": [0, 2.5]},
              {"a": [0, 4], "b": [0, 0], "thickness": 0.1, "z": [0, 2.5]},
              {"a": [3, 0], "b": [3, 4], "thickness": 0.1, "z": [0, 2.5]}],
    "doorways": [{"floor": 0, "xyz": [3, 2, 0], "width": 0.95}],
    "path": {"waypoints": [[1, 2], {"xy": [5, 2], "pause_s": 1.5}]}
  })");
}

// What the reader says of a plan; empty if it takes it.
std::string complaint(const json& plan) {
  try {
    parseScene(plan.dump(), "plan.json");
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_EQ(text.rfind("plan.json: ", 0), 0u) << text;
    return text;
  }
  return "";
}

TEST(SceneFileTest, ReadsWhatIsWritten) {
  const Scene scene = parseScene(goodPlan().dump(), "plan.json");
  EXPECT_EQ(scene.walls.size(), 5u);
  EXPECT_EQ(scene.walls[1].b, Eigen::Vector2d(6, 4));
  EXPECT_EQ(scene.doorways[0].height_m, 2.1);
  EXPECT_EQ(scene.rooms[0].polygon[2], Eigen::Vector2d(5.95, 3.95));
  EXPECT_EQ(scene.path.waypoints[1].pause_s, 1.5);
  EXPECT_EQ(scene.path.start_pause_s, 3);
  EXPECT_EQ(scene.T_body_lidar.translation, Eigen::Vector3d(0.1, 0, 0.3));
}

TEST(SceneFileTest, BrokenJsonIsNamedWithItsLine) {
  try {
    parseScene("{\n \"walls\": [\n }\n", "plan.json");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("plan.json"), HasSubstr("line 3")));
  }
}

TEST(SceneFileTest, NumberOutOfRangeIsAnError) {
  EXPECT_THROW(parseScene("{\"floors\": [1e999]}", "plan.json"), Error);
}

TEST(SceneFileTest, EachBadItemIsNamed) {
  json plan = goodPlan();
  EXPECT_EQ(complaint(plan), "");
  plan["walls"][2]["b"] = plan["walls"][2]["a"];
  EXPECT_THAT(complaint(plan), AllOf(HasSubstr("walls[2]"), HasSubstr("no length")));

  plan = goodPlan();
  plan["walls"][1]["thickness"] = -0.1;
  EXPECT_THAT(complaint(plan), AllOf(HasSubstr("walls[1]"), HasSubstr("thickness"), HasSubstr("-0.1")));

  plan = goodPlan();
  plan["walls"][3]["z"] = {2.5, 0};
  EXPECT_THAT(complaint(plan), AllOf(HasSubstr("walls[3]"), HasSubstr("height")));

  plan = goodPlan();
  plan["walls"][0]["a"] = {1, 2, 3};
  EXPECT_THAT(complaint(plan), AllOf(HasSubstr("walls[0].a"), HasSubstr("2 numbers")));

  plan = goodPlan();
  plan["walls"][0].erase("thickness");
  EXPECT_THAT(complaint(plan), HasSubstr("walls[0].thickness is missing"));

  plan = goodPlan();
  plan["doorways"][0]["xyz"] = {2, 2, 0};
  EXPECT_THAT(complaint(plan), AllOf(HasSubstr("doorways[0]"), HasSubstr("not on a wall")));

  plan = goodPlan();
  plan["doorways"][0]["floor"] = 1;
  EXPECT_THAT(complaint(plan), HasSubstr("doorways[0].floor"));

  plan = goodPlan();
  plan["boxes"] = {{{"name", "desk"}, {"center", {1, 1}}, {"size", {0, 1}}, {"z", {0, 1}}}};
  EXPECT_THAT(complaint(plan), HasSubstr("boxes[0]"));

  plan = goodPlan();
  plan["rooms"][0]["polygon"] = {{0, 0}, {1, 0}};
  EXPECT_THAT(complaint(plan), AllOf(HasSubstr("rooms[0]"), HasSubstr("R1")));

  plan = goodPlan();
  plan["T_body_lidar"]["qxyzw"] = {0, 0, 0, 2};
  EXPECT_THAT(complaint(plan), HasSubstr("T_body_lidar.qxyzw"));
}

TEST(SceneFileTest, EachBadPathIsNamed) {
  json plan = goodPlan();
  plan.erase("path");
  EXPECT_THAT(complaint(plan), HasSubstr("path is missing"));

  plan = goodPlan();
  plan["path"]["waypoints"] = json::array();
  EXPECT_THAT(complaint(plan), HasSubstr("path.waypoints is empty"));

  plan = goodPlan();
  plan["path"]["waypoints"][1] = {6, 2};
  EXPECT_THAT(complaint(plan), AllOf(HasSubstr("path.waypoints[1]"), HasSubstr("inside walls[1]")));

  plan = goodPlan();
  plan["path"]["waypoints"][1] = {5.8, 2};
  EXPECT_THAT(complaint(plan),
              AllOf(HasSubstr("path.waypoints[1]"), HasSubstr("walls[1]"), HasSubstr("keep 0.3")));

  plan = goodPlan();
  plan["path"]["waypoints"] = {{1, 3.5}, {5, 3.5}};
  EXPECT_THAT(complaint(plan),
              AllOf(HasSubstr("from path.waypoints[0] to path.waypoints[1]"), HasSubstr("walls[4]")));

  plan = goodPlan();
  plan["boxes"] = {{{"name", "desk"}, {"center", {4.5, 2}}, {"size", {0.4, 0.4}}, {"z", {0, 1}}}};
  EXPECT_THAT(complaint(plan), HasSubstr("boxes[0] 'desk'"));

  plan = goodPlan();
  plan["path"]["waypoints"] = {{1, 2}, {1, 2}};
  EXPECT_THAT(complaint(plan), HasSubstr("same as the one before"));

  plan = goodPlan();
  plan["path"]["waypoints"][0] = {{"xy", {1, 2}}, {"pause", 3}};
  EXPECT_THAT(complaint(plan), AllOf(HasSubstr("waypoints[0]"), HasSubstr("pause_s")));

  plan = goodPlan();
  plan["path"]["speed_mps"] = 30;
  EXPECT_THAT(complaint(plan), AllOf(HasSubstr("path.speed_mps"), HasSubstr("between")));
}

TEST(SceneFileTest, MisspeltKeysAreNamedAndForeignOnesPass) {
  json plan = goodPlan();
  plan["doorway"] = json::array();
  EXPECT_THAT(complaint(plan), HasSubstr("did you mean 'doorways'"));
  plan = goodPlan();
  plan["sensor"] = {{"range_sigma", 0.01}};
  EXPECT_THAT(complaint(plan), AllOf(HasSubstr("sensor.range_sigma"), HasSubstr("range_sigma_m")));
  plan = goodPlan();
  plan["drawn_by_the_architect"] = 7;
  EXPECT_EQ(complaint(plan), "");
}

TEST(SceneFileTest, WrittenPlanIsReadBack) {
  const Scene scene = loadScene(findScene("small_office"));
  const std::string path = testing::TempDir() + "/written_plan.json";
  writePlan(path, scene);
  std::ifstream in(path);
  json plan = json::parse(in);
  EXPECT_FALSE(plan.contains("path"));
  plan["path"] = {{"waypoints", {{5.0, 0.9}}}};
  const Scene again = parseScene(plan.dump(), path);
  EXPECT_EQ(buildMesh(again).vertices, buildMesh(scene).vertices);
  EXPECT_EQ(again.rooms.size(), scene.rooms.size());
  EXPECT_LT(se3Log(again.T_body_lidar.inverse() * scene.T_body_lidar).norm(), 1e-9);
}

}  // namespace
}  // namespace sgraphs::simulate
