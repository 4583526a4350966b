#include "tools/simulate/simulate.h"

#include <algorithm>
#include <filesystem>

#include "common/base/error.h"
#include "common/base/sha256.h"
#include "common/bus/log_file.h"
#include "common/io/tum.h"
#include "drivers/recording/recording_writer.h"
#include "tools/simulate/building/building.h"
#include "tools/simulate/scene/scene_file.h"
#include "tools/simulate/sensor/legs_odometry.h"
#include "tools/simulate/sensor/sensor_simulator.h"

namespace sgraphs::simulate {
namespace {

constexpr int64_t kPacketsPerBatch = 754;  // about a second
constexpr int64_t kTruthPeriod_us = 10000;

Session describe(const SimulateOptions& options, const Scene& scene, const std::string& plan_path) {
  Sha256 digest;
  digest.add(sha256OfFile(plan_path));
  digest.add(static_cast<int64_t>(options.seed));
  digest.add(static_cast<int64_t>(options.with_odometry));
  Session session;
  session.config_digest = digest.hex();
  // 60 bits of the digest, and never 0: the same recording has the same session whenever it is made.
  session.id = std::stoll(session.config_digest.substr(0, 15), nullptr, 16) | 1;
  session.start = scene.start;
  session.writer = "sgraphs simulate " SGRAPHS_VERSION;
  session.has_odometry = options.with_odometry;
  session.T_body_lidar = scene.T_body_lidar;
  return session;
}

// T_building_body at 100 Hz, and at the very end.
std::vector<StampedPose> sampleTruth(const Trajectory& trajectory) {
  std::vector<StampedPose> poses;
  for (Time t = trajectory.start(); t < trajectory.end(); t = t + Duration{kTruthPeriod_us})
    poses.push_back({t, trajectory.poseAt(t)});
  poses.push_back({trajectory.end(), trajectory.poseAt(trajectory.end())});
  return poses;
}

void writeTruth(const std::string& folder, const Scene& scene, const TriangleMesh& mesh,
                const Trajectory& trajectory) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw Error("cannot create folder '" + folder + "': " + failed.message());
  writeTum(folder + "/gt.tum", sampleTruth(trajectory));
  writePlan(folder + "/plan.json", scene);
  writePly(folder + "/mesh.ply", mesh);
}

double lengthOf(const std::vector<StampedPose>& poses) {
  double length = 0;
  for (size_t i = 1; i < poses.size(); ++i)
    length += (poses[i].pose.translation - poses[i - 1].pose.translation).head<2>().norm();
  return length;
}

// Packets and odometry, merged by time.
void writeRecording(RecordingWriter& writer, const SensorSimulator& sensor,
                    const std::vector<BodyOdometry>& odometry, const SimulateOptions& options,
                    const Progress& progress) {
  const int64_t total = sensor.numPackets();
  auto sample = odometry.begin();
  for (int64_t first = 0; first < total; first += kPacketsPerBatch) {
    const int64_t count = std::min(kPacketsPerBatch, total - first);
    for (const SensorPacket& packet : sensor.packets(first, count, options.num_threads)) {
      for (; sample != odometry.end() && sample->time < packet.time; ++sample) writer.addOdometry(*sample);
      writer.addPacket({packet.time, packet.bytes});
    }
    const double packet_s = vlp16::kPacketPeriod_us * 1e-6;
    if (progress)
      progress(static_cast<double>(first + count) * packet_s, static_cast<double>(total) * packet_s);
  }
  for (; sample != odometry.end(); ++sample) writer.addOdometry(*sample);
  writer.finish();
}

}  // namespace

SimulateResult simulate(const SimulateOptions& options, const Progress& progress) {
  if (options.num_threads < 1) throw UsageError("--threads must be at least 1");
  const std::string plan_path = findScene(options.scene);
  const Scene scene = loadScene(plan_path);
  const TriangleMesh mesh = buildMesh(scene);
  const RayCaster caster(mesh, buildGlass(scene));
  const Trajectory trajectory =
      walkAlong(scene.path, scene.start, scene.floors_z_m[static_cast<size_t>(scene.path_floor)]);
  const SensorSimulator sensor(caster, trajectory, scene.T_body_lidar, scene.sensor, options.seed,
                               People(scene.people, scene.floors_z_m));
  std::vector<BodyOdometry> odometry;
  if (options.with_odometry) odometry = simulateLegsOdometry(trajectory, {}, options.seed);

  if (!options.truth_dir.empty()) writeTruth(options.truth_dir, scene, mesh, trajectory);
  LogWriter log(options.output);
  RecordingWriter writer(log, describe(options, scene, plan_path));
  writeRecording(writer, sensor, odometry, options, progress);
  log.close();

  return {trajectory.duration().seconds(), lengthOf(sampleTruth(trajectory)), sensor.numPackets(),
          static_cast<int64_t>(odometry.size())};
}

}  // namespace sgraphs::simulate
