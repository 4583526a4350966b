// Two walks through one building: the second goes on with the map of the first, without being told where it
// begins.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace sgraphs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using ::testing::HasSubstr;

struct Outcome {
  int code = -1;
  std::string text;  // stdout and stderr
};

std::string readAll(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

class SessionsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = fs::path(::testing::TempDir()) / ("sessions_test_" + std::to_string(getpid()));
    fs::create_directories(folder);
    // From the other room, turned by 137 degrees, there and back.
    std::ofstream(folder / "walk.json")
        << R"({"start_heading_deg": 167, "start_pause_s": 2, "end_pause_s": 1, "waypoints":
               [[5.8, 1.2], [5.0, 2.2], [2.0, 2.2], [1.2, 1.0], [2.0, 2.2], [4.6, 2.2]]})";
    std::ofstream(folder / "short.json")
        << R"({"start_heading_deg": 167, "start_pause_s": 2, "end_pause_s": 1, "waypoints":
               [[5.8, 1.2], [5.0, 2.2]]})";
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }

  static std::string at(const std::string& name) { return "'" + (folder / name).string() + "'"; }
  static Outcome run(const std::string& command) {
    const fs::path said = folder / "said.txt";
    const int status =
        std::system((SGRAPHS_BINARY_DIR "/sgraphs " + command + " > '" + said.string() + "' 2>&1").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readAll(said)};
  }
  static void simulate(const std::string& log, const std::string& options) {
    if (fs::exists(folder / log)) return;
    ok("simulate '" SGRAPHS_SOURCE_DIR "/config/scenes/two_rooms/plan.json' -o " + at(log) + " " + options);
  }
  // The first walk and its map, and a second walk.
  static void makeFirst() {
    if (fs::exists(folder / "out1")) return;
    simulate("first.lcmlog", "--seed 1");
    simulate("second.lcmlog", "--waypoints " + at("walk.json") + " --truth " + at("truth") + " --seed 2");
    ok("replay " + at("first.lcmlog") + " -o " + at("out1"));
  }
  // And the map of both.
  static void makeSecond() {
    makeFirst();
    if (!fs::exists(folder / "out2"))
      ok("replay " + at("second.lcmlog") + " --map " + at("out1") + " -o " + at("out2"));
  }
  static void ok(const std::string& command) {
    const Outcome outcome = run(command);
    ASSERT_EQ(outcome.code, 0) << command << ":\n" << outcome.text;
  }
  static Json json(const std::string& name) { return Json::parse(readAll(folder / name)); }
  static size_t rows(const std::string& name) {
    const std::string text = readAll(folder / name);
    return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
  }
  static size_t keyframesIn(const std::string& name, int session) {
    size_t n = 0;
    const Json graph = json(name);
    for (const Json& node : graph["nodes"])
      n += node["layer"] == "keyframes" && node.value("session", 0) == session;
    return n;
  }

  static fs::path folder;
};
fs::path SessionsTest::folder;

TEST_F(SessionsTest, TheSecondWalkIsPlacedInTheMapOfTheFirst) {
  makeSecond();
  const Json first = json("out1/summary.json"), second = json("out2/summary.json");
  EXPECT_TRUE(second["reproducible"]);
  const Json& map = second["map"];
  EXPECT_EQ(map["graph_digest"], first["graph_digest"]);
  EXPECT_TRUE(map["same_when_loaded"]) << "everything survives";
  EXPECT_EQ(map["keyframes"].get<size_t>(), keyframesIn("out1/graph.json", 0));
  EXPECT_LE(map["found_after_m"].get<double>(), 10.0);

  ok("eval " + at("out2") + " --truth " + at("truth"));
  const Json eval = json("out2/eval.json");
  EXPECT_LT(eval["trajectories"]["trajectory.tum"]["ate_m"]["rmse"].get<double>(), 0.03);
  EXPECT_LT(eval["map"]["distance_m"]["rmse"].get<double>(), 0.03);
  EXPECT_EQ(eval["walls"]["asked"]["missed"], 0);
  EXPECT_EQ(eval["walls"]["asked"]["doubled"], 0);
  EXPECT_TRUE(eval["walls"]["false"].empty());
  EXPECT_EQ(eval["rooms"]["recall"], 1.0);
  EXPECT_EQ(eval["rooms"]["precision"], 1.0);
  EXPECT_EQ(eval["doorways"]["false"], 0);

  // Trajectories are of this run, the graph is of both.
  EXPECT_EQ(keyframesIn("out2/graph.json", 0), keyframesIn("out1/graph.json", 0));
  EXPECT_EQ(keyframesIn("out2/graph.json", 1), rows("out2/keyframes.tum"));
  EXPECT_EQ(rows("out2/trajectory.tum"), rows("out2/odometry.tum"));
  // Both recordings begin at one time of their clocks; odom is where the robot was at first.
  std::istringstream row1(readAll(folder / "out1/odometry.tum")), row2(readAll(folder / "out2/odometry.tum"));
  double t1 = 0, t2 = 0, x = 1, y = 1;
  row1 >> t1;
  row2 >> t2 >> x >> y;
  EXPECT_NEAR(t1, t2, 0.2);
  EXPECT_LT(std::hypot(x, y), 0.05);
}

TEST_F(SessionsTest, TwoThreadsGiveTheSameBytes) {
  makeSecond();
  ok("replay " + at("second.lcmlog") + " --map " + at("out1") + " -o " + at("out2_threads") + " --threads 2");
  EXPECT_EQ(json("out2/summary.json")["graph_digest"], json("out2_threads/summary.json")["graph_digest"]);
  for (const char* file : {"graph.json", "graph.g2o", "map.ply", "map.lcmlog", "trajectory.tum",
                           "keyframes.tum", "odometry.tum", "floorplan_f0.svg", "occupancy_f0.pgm"}) {
    const std::string one = readAll(folder / "out2" / file);
    EXPECT_FALSE(one.empty()) << file;
    EXPECT_TRUE(one == readAll(folder / "out2_threads" / file)) << file;
  }
}

TEST_F(SessionsTest, AThirdWalkGoesOnWithTheSecondsMapAlsoInPlace) {
  makeSecond();
  fs::copy(folder / "out2", folder / "out3", fs::copy_options::recursive);
  ok("replay " + at("second.lcmlog") + " --map " + at("out3") + " -o " + at("out3"));
  const Json summary = json("out3/summary.json");
  EXPECT_EQ(summary["map"]["graph_digest"], json("out2/summary.json")["graph_digest"]);
  EXPECT_TRUE(summary["map"]["same_when_loaded"]);
  EXPECT_EQ(summary["map"]["sessions"], 2);
  EXPECT_EQ(keyframesIn("out3/graph.json", 2), keyframesIn("out2/graph.json", 1));
}

TEST_F(SessionsTest, ARobotThatIsNotFoundFailsInOneLineAndWritesNothing) {
  makeFirst();
  simulate("short.lcmlog", "--waypoints " + at("short.json") + " --seed 3");
  const Outcome lost = run("replay " + at("short.lcmlog") + " --map " + at("out1") + " -o " + at("lost"));
  EXPECT_EQ(lost.code, 1);
  EXPECT_THAT(lost.text, HasSubstr("the robot was not found in map"));
  EXPECT_THAT(lost.text, HasSubstr("m of walking"));
  EXPECT_EQ(std::count(lost.text.begin(), lost.text.end(), '\n'), 1) << lost.text;
  EXPECT_TRUE(fs::is_empty(folder / "lost"));
}

TEST_F(SessionsTest, AnotherConfigurationIsNamedAndTheRunGoesOn) {
  makeFirst();
  const Outcome other = run("replay " + at("second.lcmlog") + " --map " + at("out1") + " -o " + at("other") +
                            " --set backend.rooms.wall_sigma_m=0.05");
  EXPECT_EQ(other.code, 0) << other.text;
  EXPECT_THAT(other.text, HasSubstr("another configuration (config_digest"));
  EXPECT_FALSE(json("other/summary.json")["map"]["same_when_loaded"]);
}

// The line of an error, for a map that differs from the first one by what `damage` does to it.
TEST_F(SessionsTest, WhatIsNoMapIsRefusedInOneLine) {
  makeFirst();
  const auto refusal = [&](const std::function<void(const fs::path&)>& damage) {
    fs::remove_all(folder / "bad");
    fs::copy(folder / "out1", folder / "bad", fs::copy_options::recursive);
    damage(folder / "bad");
    const Outcome o = run("replay " + at("second.lcmlog") + " --map " + at("bad") + " -o " + at("refused"));
    EXPECT_EQ(o.code, 1) << o.text;
    EXPECT_EQ(std::count(o.text.begin(), o.text.end(), '\n'), 1) << o.text;
    return o.text;
  };
  EXPECT_THAT(refusal([](const fs::path& p) { fs::remove_all(p); }), HasSubstr("is no folder"));
  EXPECT_THAT(refusal([](const fs::path& p) { fs::remove(p / "summary.json"); }),
              HasSubstr("holds no summary.json"));
  EXPECT_THAT(refusal([](const fs::path& p) { std::ofstream(p / "summary.json") << "{}"; }),
              HasSubstr("cannot read"));
  EXPECT_THAT(refusal([](const fs::path& p) { fs::remove(p / "map.lcmlog"); }),
              HasSubstr("holds no map.lcmlog"));
  EXPECT_THAT(refusal([](const fs::path& p) { std::ofstream(p / "map.lcmlog") << "no log"; }),
              HasSubstr("map.lcmlog"));
  EXPECT_THAT(refusal([](const fs::path& p) {
                fs::resize_file(p / "map.lcmlog", fs::file_size(p / "map.lcmlog") * 2 / 3);
              }),
              HasSubstr("damaged"));
  EXPECT_THAT(refusal([](const fs::path& p) {
                fs::copy_file(folder / "first.lcmlog", p / "map.lcmlog",
                              fs::copy_options::overwrite_existing);
              }),
              HasSubstr("map.lcmlog"));
  EXPECT_FALSE(fs::exists(folder / "refused" / "map.lcmlog.part"));
}

}  // namespace
}  // namespace sgraphs
