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
std::string planComplaint(const json& plan) {
  try {
    parseScene(plan.dump(), "plan.json");
  } catch (const Error& error) {
    std::string text = error.what();
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
  EXPECT_EQ(planComplaint(plan), "");
  plan["walls"][2]["b"] = plan["walls"][2]["a"];
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("walls[2]"), HasSubstr("no length")));

  plan = goodPlan();
  plan["walls"][1]["thickness"] = -0.1;
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("walls[1]"), HasSubstr("thickness"), HasSubstr("-0.1")));

  plan = goodPlan();
  plan["walls"][3]["z"] = {2.5, 0};
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("walls[3]"), HasSubstr("height")));

  plan = goodPlan();
  plan["walls"][0]["a"] = {1, 2, 3};
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("walls[0].a"), HasSubstr("2 numbers")));

  plan = goodPlan();
  plan["walls"][0].erase("thickness");
  EXPECT_THAT(planComplaint(plan), HasSubstr("walls[0].thickness is missing"));

  plan = goodPlan();
  plan["doorways"][0]["xyz"] = {2, 2, 0};
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("doorways[0]"), HasSubstr("not on a wall")));

  plan = goodPlan();
  plan["doorways"][0]["floor"] = 1;
  EXPECT_THAT(planComplaint(plan), HasSubstr("doorways[0].floor"));

  plan = goodPlan();
  plan["boxes"] = {{{"name", "desk"}, {"center", {1, 1}}, {"size", {0, 1}}, {"z", {0, 1}}}};
  EXPECT_THAT(planComplaint(plan), HasSubstr("boxes[0]"));

  plan = goodPlan();
  plan["rooms"][0]["polygon"] = {{0, 0}, {1, 0}};
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("rooms[0]"), HasSubstr("R1")));

  plan = goodPlan();
  plan["T_body_lidar"]["qxyzw"] = {0, 0, 0, 2};
  EXPECT_THAT(planComplaint(plan), HasSubstr("T_body_lidar.qxyzw"));
}

json planWithLift() {
  json plan = goodPlan();
  plan["floors"] = {0.0, 3.0};
  plan["slabs"] = {{{"min", {0, 0}}, {"max", {6, 4}}, {"z", {2.8, 3.0}}}};
  for (const json& wall : json(plan["walls"])) {
    plan["walls"].push_back(wall);
    plan["walls"].back()["z"] = {3.0, 5.5};
  }
  plan["doorways"].push_back({{"floor", 1}, {"xyz", {3, 2, 3}}, {"width", 0.95}});
  plan["lifts"] = {
      {{"name", "A"}, {"floors", {0, 1}}, {"door", {{3, 1.55}, {3, 2.45}}}, {"door_height", 2.0}}};
  plan["path"]["waypoints"] = {{1, 2}, {{"xy", {5, 2}}, {"lift", "A"}, {"to_floor", 1}}, {1, 2}};
  return plan;
}

TEST(SceneFileTest, LiftsAreReadWithTheRidesOfThePath) {
  const Scene scene = parseScene(planWithLift().dump(), "plan.json");
  ASSERT_EQ(scene.lifts.size(), 1u);
  EXPECT_EQ(scene.lifts[0].floors, (std::vector<int>{0, 1}));
  EXPECT_EQ(scene.lifts[0].door_b, Eigen::Vector2d(3, 2.45));
  const auto& points = scene.path.waypoints;
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points[1].lift, 0);
  EXPECT_EQ(points[1].ride_m, 3.0);
  EXPECT_EQ(points[1].ridden_m, 0.0);
  EXPECT_EQ(points[2].ridden_m, 3.0);
  EXPECT_EQ(points[2].rise_m, 0.0) << "what feet climb";
}

TEST(SceneFileTest, EachBadLiftIsNamed) {
  json plan = planWithLift();
  plan["lifts"][0]["floors"] = {0};
  plan["path"]["waypoints"] = {{1, 2}, {5, 2}};
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("lifts[0]"), HasSubstr("two floors")));
  plan["lifts"][0]["floors"] = {0, 2};
  EXPECT_THAT(planComplaint(plan), HasSubstr("lifts[0].floors"));
  plan = planWithLift();
  plan["lifts"][0]["door"] = {{3, 1}, {3, 1}};
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("lifts[0]"), HasSubstr("width")));
  plan = planWithLift();
  plan["doorways"].erase(1);
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("lifts[0]"), HasSubstr("floor 1 has no doorway")));
  plan = planWithLift();
  plan["path"]["waypoints"][1]["to_floor"] = 3;
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("waypoints[1]"), HasSubstr("to_floor is 3")));
  plan["path"]["waypoints"][1]["lift"] = "B";
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("waypoints[1]"), HasSubstr("'B' is not one")));
  plan = planWithLift();
  plan["path"]["waypoints"] = {{1, 2},
                               {{"xy", {5, 2}}, {"lift", "A"}, {"to_floor", 1}},
                               {{"xy", {1, 2}}, {"z", 3.0}},
                               {{"xy", {5, 2}}, {"lift", "A"}, {"to_floor", 0}}};
  EXPECT_EQ(planComplaint(plan), "");
}

TEST(SceneFileTest, EachBadPathIsNamed) {
  json plan = goodPlan();
  plan.erase("path");
  EXPECT_THAT(planComplaint(plan), HasSubstr("path is missing"));

  plan = goodPlan();
  plan["path"]["waypoints"] = json::array();
  EXPECT_THAT(planComplaint(plan), HasSubstr("path.waypoints is empty"));

  plan = goodPlan();
  plan["path"]["waypoints"][1] = {6, 2};
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("path.waypoints[1]"), HasSubstr("inside walls[1]")));

  plan = goodPlan();
  plan["path"]["waypoints"][1] = {5.8, 2};
  EXPECT_THAT(planComplaint(plan),
              AllOf(HasSubstr("path.waypoints[1]"), HasSubstr("walls[1]"), HasSubstr("keep 0.3")));

  plan = goodPlan();
  plan["path"]["waypoints"] = {{1, 3.5}, {5, 3.5}};
  EXPECT_THAT(planComplaint(plan),
              AllOf(HasSubstr("from path.waypoints[0] to path.waypoints[1]"), HasSubstr("walls[4]")));

  plan = goodPlan();
  plan["boxes"] = {{{"name", "desk"}, {"center", {4.5, 2}}, {"size", {0.4, 0.4}}, {"z", {0, 1}}}};
  EXPECT_THAT(planComplaint(plan), HasSubstr("boxes[0] 'desk'"));

  plan = goodPlan();
  plan["path"]["waypoints"] = {{1, 2}, {1, 2}};
  EXPECT_THAT(planComplaint(plan), HasSubstr("same as the one before"));

  plan = goodPlan();
  plan["path"]["waypoints"][0] = {{"xy", {1, 2}}, {"pause", 3}};
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("waypoints[0]"), HasSubstr("pause_s")));

  plan = goodPlan();
  plan["path"]["speed_mps"] = 30;
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("path.speed_mps"), HasSubstr("between")));
}

TEST(SceneFileTest, MisspeltKeysAreNamedAndForeignOnesPass) {
  json plan = goodPlan();
  plan["doorway"] = json::array();
  EXPECT_THAT(planComplaint(plan), HasSubstr("did you mean 'doorways'"));
  plan = goodPlan();
  plan["sensor"] = {{"range_sigma", 0.01}};
  EXPECT_THAT(planComplaint(plan), AllOf(HasSubstr("sensor.range_sigma"), HasSubstr("range_sigma_m")));
  plan = goodPlan();
  plan["drawn_by_the_architect"] = 7;
  EXPECT_EQ(planComplaint(plan), "");
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

// The good plan with one of everything.
json fullPlan() {
  json plan = goodPlan();
  plan["floors"] = {0.0, 3.0};
  plan["walls"][4]["glass"] = true;
  plan["windows"] = json::parse(R"([{"xyz": [1.5, 0, 0.9], "width": 1.0, "height": 1.2, "glazed": true}])");
  plan["columns"] = json::parse(R"([{"name": "c", "center": [1, 3.3], "radius": 0.2, "z": [0, 2.5]}])");
  plan["stairs"] =
      json::parse(R"([{"foot": [3.6, 0.6], "top": [5.4, 0.6], "width": 0.8, "z": [0, 1.2], "steps": 6}])");
  plan["people"] =
      json::parse(R"([{"floor": 0, "waypoints": [[1, 1], [2, 1]], "speed_mps": 0.9, "start_s": 4}])");
  plan["meshes"] = json::parse(
      R"([{"path": "a.obj", "scale": 0.001, "T_building_mesh": {"xyz": [1, 2, 3], "rpy_deg": [90, 0, 0]}}])");
  plan["legs"] = json::parse(R"({"scale": 0.02, "clock_offset_s": -0.1})");
  plan["faults"] = json::parse(R"({"packet_loss": 0.1, "silences": [{"begin_s": 5, "duration_s": 1}],
      "clock_jumps": [{"at_s": 7, "by_s": -2}]})");
  return plan;
}

TEST(SceneFileTest, ReadsEveryItem) {
  const Scene scene = parseScene(fullPlan().dump(), "plan.json");
  EXPECT_TRUE(scene.walls[4].glass);
  EXPECT_FALSE(scene.walls[3].glass);
  EXPECT_EQ(scene.windows.at(0).xyz, Eigen::Vector3d(1.5, 0, 0.9));
  EXPECT_EQ(scene.windows[0].height_m, 1.2);
  EXPECT_TRUE(scene.windows[0].glazed);
  EXPECT_EQ(scene.columns.at(0).radius_m, 0.2);
  EXPECT_EQ(scene.columns[0].z_max_m, 2.5);
  EXPECT_EQ(scene.stairs.at(0).top, Eigen::Vector2d(5.4, 0.6));
  EXPECT_EQ(scene.stairs[0].steps, 6);
  EXPECT_EQ(scene.people.at(0).waypoints.size(), 2u);
  EXPECT_EQ(scene.people[0].speed_mps, 0.9);
  EXPECT_EQ(scene.people[0].start_s, 4);
  EXPECT_EQ(scene.meshes.at(0).path, "a.obj");
  EXPECT_EQ(scene.meshes[0].scale, 0.001);
  EXPECT_EQ(scene.meshes[0].T_building_mesh.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(scene.legs.scale, 0.02);
  EXPECT_EQ(scene.legs.clock_offset_s, -0.1);
  EXPECT_EQ(scene.legs.turn_scale, LegsOdometryModel().turn_scale);
  EXPECT_EQ(scene.faults.packet_loss, 0.1);
  EXPECT_EQ(scene.faults.silences.at(0).begin_s, 5);
  EXPECT_EQ(scene.faults.clock_jumps.at(0).by_s, -2);
}

TEST(SceneFileTest, WaypointHeightHoldsForThoseThatFollow) {
  json plan = goodPlan();
  plan["floors"] = {0.0, 0.25, 0.5};
  plan["path"]["floor"] = 1;
  plan["path"]["waypoints"] = json::parse(
      R"([[1, 2], {"xy": [1.5, 2], "z": 0.25}, {"xy": [4, 2], "z": 0.5}, [5, 2], {"xy": [5, 3], "z": 0.25}])");
  const Scene scene = parseScene(plan.dump(), "plan.json");
  std::vector<double> rises;
  for (const Waypoint& waypoint : scene.path.waypoints) rises.push_back(waypoint.rise_m);
  EXPECT_THAT(rises, testing::ElementsAre(0, 0, 0.25, 0.25, 0));
}

TEST(SceneFileTest, EachBadMemberOfTheNewItemsIsNamed) {
  const auto with = [](const char* pointer, const json& value) {
    json plan = fullPlan();
    plan[json::json_pointer(pointer)] = value;
    return planComplaint(plan);
  };
  EXPECT_EQ(planComplaint(fullPlan()), "");
  EXPECT_THAT(with("/walls/0/glass", 1), AllOf(HasSubstr("walls[0].glass"), HasSubstr("true or false")));
  EXPECT_THAT(with("/walls/0/glas", true), AllOf(HasSubstr("walls[0].glas"), HasSubstr("'glass'")));
  EXPECT_THAT(with("/windows/0/xyz", {1, 2, 0}), AllOf(HasSubstr("windows[0]"), HasSubstr("not on a wall")));
  EXPECT_THAT(with("/columns/0/radious", 1), AllOf(HasSubstr("columns[0].radious"), HasSubstr("'radius'")));
  EXPECT_THAT(with("/columns/0/radius", -1), AllOf(HasSubstr("columns[0]"), HasSubstr("radius")));
  EXPECT_THAT(with("/stairs/0/steps", 0), AllOf(HasSubstr("stairs[0]"), HasSubstr("steps")));
  EXPECT_THAT(with("/stairs/0/steps", 2.5), AllOf(HasSubstr("stairs[0].steps"), HasSubstr("whole")));
  EXPECT_THAT(with("/stairs/0/top", {3.6, 0.6}), AllOf(HasSubstr("stairs[0]"), HasSubstr("no length")));
  EXPECT_THAT(with("/people/0/waypoints", json::array()),
              AllOf(HasSubstr("people[0]"), HasSubstr("waypoints")));
  EXPECT_THAT(with("/people/0/floor", 2), HasSubstr("people[0].floor"));
  EXPECT_THAT(with("/people/0/speed", 2), AllOf(HasSubstr("people[0].speed"), HasSubstr("'speed_mps'")));
  EXPECT_THAT(with("/meshes/0/path", ""), HasSubstr("meshes[0].path"));
  EXPECT_THAT(with("/meshes/0/scale", 0), AllOf(HasSubstr("meshes[0].scale"), HasSubstr("between")));
  EXPECT_THAT(with("/legs/scale", 3), AllOf(HasSubstr("legs.scale"), HasSubstr("between")));
  EXPECT_THAT(with("/legs/yaw_bias", 0),
              AllOf(HasSubstr("legs.yaw_bias"), HasSubstr("'yaw_bias_rad_per_m'")));
  EXPECT_THAT(with("/faults/packet_loss", 1.5), AllOf(HasSubstr("faults.packet_loss"), HasSubstr("between")));
  EXPECT_THAT(with("/faults/packet_los", 0),
              AllOf(HasSubstr("faults.packet_los"), HasSubstr("'packet_loss'")));
  EXPECT_THAT(with("/faults/silences/0", {{"begin_s", 1}}), HasSubstr("faults.silences[0] needs"));
  EXPECT_THAT(with("/path/waypoints/1/z", "high"), AllOf(HasSubstr("waypoints[1]"), HasSubstr("z must be")));
}

TEST(SceneFileTest, WrittenPlanHoldsTheBuildingAndNothingOfTheRun) {
  const Scene scene = parseScene(fullPlan().dump(), "plan.json");
  const std::string path = testing::TempDir() + "/written_full_plan.json";
  writePlan(path, scene);
  std::ifstream in(path);
  json plan = json::parse(in);
  for (const char* key : {"path", "people", "faults", "legs", "sensor", "meshes", "slabs"})
    EXPECT_FALSE(plan.contains(key)) << key;
  plan["path"] = fullPlan()["path"];
  plan["path"]["waypoints"] = json::parse("[[1, 2]]");
  const Scene again = parseScene(plan.dump(), path);
  EXPECT_EQ(buildMesh(again).vertices, buildMesh(scene).vertices);
  EXPECT_EQ(buildGlass(again).vertices, buildGlass(scene).vertices);
  EXPECT_EQ(buildGlass(again).triangles.size(), 8u);  // window, and a wall around its doorway
  EXPECT_EQ(again.columns[0].name, "c");
}

}  // namespace
}  // namespace sgraphs::simulate
