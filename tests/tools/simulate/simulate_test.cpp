#include "tools/simulate/simulate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "common/base/error.h"
#include "common/base/sha256.h"
#include "common/bus/channels.h"
#include "common/bus/log_file.h"
#include "common/io/tum.h"
#include "drivers/velodyne/vlp16_decoder.h"
#include "lcmtypes/convert/convert.h"
#include "tools/simulate/building/building.h"
#include "tools/simulate/building/ray_caster.h"
#include "tools/simulate/scene/find_scene.h"
#include "tools/simulate/scene/scene_file.h"

namespace sgraphs::simulate {
namespace {

std::string scratch(const std::string& name) {
  // Tests run side by side: each has its own files.
  return testing::TempDir() + "/simulate_" + testing::UnitTest::GetInstance()->current_test_info()->name() +
         "_" + name;
}

// A walk of two seconds in the two rooms.
SimulateOptions shortRun(const std::string& name) {
  std::ifstream in(findScene("two_rooms"));
  std::stringstream text;
  text << in.rdbuf();
  std::string plan = text.str();
  const size_t begin = plan.find("\"path\"");
  plan.replace(begin, std::string::npos,
               R"("path": {"start_pause_s": 0.5, "end_pause_s": 0, "start_heading_deg": 90,
                  "waypoints": [[1.2, 1.0], [1.2, 1.6]]}})");
  const std::string path = scratch("plan.json");
  std::ofstream(path) << plan;
  SimulateOptions options;
  options.scene = path;
  options.output = scratch(name + ".lcmlog");
  return options;
}

const std::vector<std::string> kAllFaults{"faults.packet_loss=0.05",
                                          "faults.packet_duplicates=0.05",
                                          "faults.packet_reorders=0.05",
                                          "faults.packet_corruption=0.05",
                                          "faults.silences=[{\"begin_s\": 0.5, \"duration_s\": 0.1}]",
                                          "faults.clock_jumps=[{\"at_s\": 1, \"by_s\": 2}]"};

TEST(SimulateTest, LogIsTheSameAtAnyNumberOfThreads) {
  SimulateOptions one = shortRun("one"), three = shortRun("three"), other = shortRun("other");
  one.with_odometry = three.with_odometry = other.with_odometry = true;
  three.num_threads = 3;
  other.seed = 2;
  simulate(one);
  simulate(three);
  simulate(other);
  EXPECT_EQ(sha256OfFile(one.output), sha256OfFile(three.output));
  EXPECT_NE(sha256OfFile(one.output), sha256OfFile(other.output));
}

TEST(SimulateTest, LogHoldsTheRawChannelsOnlyInOrderOfTime) {
  SimulateOptions options = shortRun("channels");
  options.with_odometry = true;
  const SimulateResult result = simulate(options);
  LogReader log(options.output);
  std::map<std::string, int64_t> events;
  std::string first, last;
  int64_t packets = 0, previous_us = 0, previous_odometry_us = 0;
  while (const auto event = log.next()) {
    if (first.empty()) first = event->channel;
    last = event->channel;
    ++events[event->channel];
    EXPECT_GE(event->timestamp_us, previous_us);
    previous_us = event->timestamp_us;
    if (velodyne_packets_t message{}; event->channel == "VELODYNE_PACKETS" && decode(event->bytes, message))
      packets += message.num_packets;
    if (spot_odometry_t message{}; event->channel == "SPOT_ODOMETRY" && decode(event->bytes, message)) {
      EXPECT_GT(message.header.utime, previous_odometry_us);
      previous_odometry_us = message.header.utime;
    }
  }
  EXPECT_EQ(first, "SESSION");
  EXPECT_EQ(last, "STREAM_END");
  EXPECT_EQ(events.size(), 4u);
  EXPECT_EQ(packets, result.packets);
  EXPECT_EQ(events["SPOT_ODOMETRY"], result.odometry_samples);
  EXPECT_NEAR(static_cast<double>(result.odometry_samples), result.duration_s * 50, 2);
}

TEST(SimulateTest, SessionTellsTheMountAndNoOdometryUnlessAsked) {
  const SimulateOptions options = shortRun("session");
  EXPECT_EQ(simulate(options).odometry_samples, 0);
  LogReader log(options.output);
  const auto event = log.next();
  ASSERT_TRUE(event.has_value());
  session_t message{};
  ASSERT_TRUE(decode(event->bytes, message));
  const auto session = fromMessage(message);
  ASSERT_TRUE(session.has_value());
  EXPECT_FALSE(session->has_odometry);
  EXPECT_NE(message.header.session, 0);
  const SE3 mount = loadScene(options.scene).T_body_lidar;
  EXPECT_LT(se3Log(mount.inverse() * session->T_body_lidar).norm(), 1e-9);
}

TEST(SimulateTest, TruthPutsTheRecordedPointsOnTheWrittenPlan) {
  SimulateOptions options = shortRun("truth");
  options.truth_dir = scratch("truth");
  simulate(options);
  const auto truth = readTum(options.truth_dir + "/gt.tum");
  const Scene scene = loadScene(options.scene);
  const RayCaster building(buildMesh(scene));
  RevolutionAssembler assembler;
  LogReader log(options.output);
  double squares = 0;
  int64_t count = 0;
  while (const auto event = log.next()) {
    velodyne_packets_t message{};
    if (event->channel != "VELODYNE_PACKETS" || !decode(event->bytes, message)) continue;
    const auto packets = fromMessage(message);
    ASSERT_TRUE(packets.has_value());
    for (const VelodynePacket& packet : *packets) {
      const auto scan = assembler.step(packet.time, packet.bytes);
      if (!scan) continue;
      for (size_t i = 0; i < scan->points.size(); i += 37) {
        const Time t = scan->end + Duration{scan->points[i].time_us};
        const auto k = static_cast<size_t>((t - truth.front().time).us / 10000);
        ASSERT_LT(k + 1, truth.size());
        const double share = (t - truth[k].time).seconds() / (truth[k + 1].time - truth[k].time).seconds();
        const SE3 T = interpolate(truth[k].pose, truth[k + 1].pose, share) * scene.T_body_lidar;
        const Eigen::Vector3d p = T * Eigen::Vector3d(scan->points[i].position_lidar.cast<double>());
        squares += std::pow(building.distanceToSurface(p), 2);
        ++count;
      }
    }
  }
  ASSERT_GT(count, 1000);
  // 15 mm along the ray; less across a surface that is seen obliquely.
  const double rms = std::sqrt(squares / static_cast<double>(count));
  EXPECT_LT(rms, 0.016);
  EXPECT_GT(rms, 0.006);
  EXPECT_TRUE(std::filesystem::exists(options.truth_dir + "/plan.json"));
}

TEST(SimulateTest, WrittenMeshIsTheBuilding) {
  SimulateOptions options = shortRun("mesh");
  options.truth_dir = scratch("mesh_truth");
  simulate(options);
  const TriangleMesh mesh = buildMesh(loadScene(options.scene));
  std::ifstream in(options.truth_dir + "/mesh.ply");
  std::string line;
  size_t header = 1, rows = 0;
  while (std::getline(in, line) && line != "end_header") ++header;
  EXPECT_EQ(header, 9u);
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    ASSERT_TRUE(std::getline(in, line));
    std::istringstream row(line);
    Eigen::Vector3d read;
    row >> read.x() >> read.y() >> read.z();
    EXPECT_LT((read - vertex).norm(), 2e-5);
  }
  while (std::getline(in, line)) ++rows;
  EXPECT_EQ(rows, mesh.triangles.size());
}

TEST(SimulateTest, ProgressReachesTheEnd) {
  double done = 0, total = 1;
  simulate(shortRun("progress"), [&](double done_s, double total_s) {
    EXPECT_GT(done_s, done);
    done = done_s;
    total = total_s;
  });
  EXPECT_NEAR(done, total, 1e-9);
}

TEST(SimulateTest, UnwritableOutputIsNamed) {
  SimulateOptions options = shortRun("unwritable");
  options.output = "/nonexistent/folder/run.lcmlog";
  EXPECT_THROW(simulate(options), Error);
}

// Faults, overrides and a mesh, by the command's own way.
TEST(SimulateTest, FaultyLogIsTheSameAtAnyNumberOfThreadsAndInOrderOfTime) {
  SimulateOptions one = shortRun("faults_one"), three = shortRun("faults_three");
  one.with_odometry = three.with_odometry = true;
  one.overrides = three.overrides = kAllFaults;
  three.num_threads = 3;
  const SimulateResult result = simulate(one);
  simulate(three);
  EXPECT_EQ(sha256OfFile(one.output), sha256OfFile(three.output));
  EXPECT_GT(result.faults.lost, 10);
  EXPECT_GT(result.faults.duplicated, 10);
  EXPECT_GT(result.faults.reordered, 10);
  EXPECT_GT(result.faults.corrupted, 10);
  EXPECT_GT(result.faults.silenced, 50);
  LogReader log(one.output);
  int64_t packets = 0, previous_us = 0;
  while (const auto event = log.next()) {
    EXPECT_GE(event->timestamp_us, previous_us);
    previous_us = event->timestamp_us;
    if (velodyne_packets_t message{}; event->channel == "VELODYNE_PACKETS" && decode(event->bytes, message))
      packets += static_cast<int64_t>(fromMessage(message).value().size());
  }
  EXPECT_EQ(packets, result.packets);
}

TEST(SimulateTest, OdometryOfAnotherClockStandsWhereItArrived) {
  SimulateOptions options = shortRun("offset");
  options.with_odometry = true;
  options.overrides = {"legs.clock_offset_s=0.4"};
  simulate(options);
  LogReader log(options.output);
  int64_t samples = 0;
  while (const auto event = log.next()) {
    spot_odometry_t message{};
    if (event->channel != "SPOT_ODOMETRY" || !decode(event->bytes, message)) continue;
    // Packets of up to 26 ms may stand before it.
    ASSERT_NEAR(static_cast<double>(message.header.utime - event->timestamp_us), 400000, 30000);
    ++samples;
  }
  EXPECT_GT(samples, 50);
}

TEST(SimulateTest, MeshIsWalkedThroughAndBecomesTheTruth) {
  SimulateOptions options = shortRun("of_mesh");
  TriangleMesh room;
  room.addBox({3, 2, 1.25}, {6, 4, 2.5}, 0, 50);
  options.scene = scratch("room.ply");
  writePly(options.scene, room);
  options.waypoints = scratch("walk.json");
  std::ofstream(options.waypoints)
      << R"({"waypoints": [[2, 2], [2.5, 2]], "start_pause_s": 0, "end_pause_s": 0})";
  options.truth_dir = scratch("of_mesh_truth");
  const SimulateResult result = simulate(options);
  EXPECT_GT(result.packets, 500);
  EXPECT_EQ(result.building,
            std::filesystem::path(options.scene).stem().string() + " (mesh of 12 triangles)");
  EXPECT_NEAR(readTum(options.truth_dir + "/gt.tum").front().pose.translation.z(), 0.52, 0.02);
  EXPECT_GT(std::filesystem::file_size(options.truth_dir + "/mesh.ply"), 300u);
}

}  // namespace
}  // namespace sgraphs::simulate
