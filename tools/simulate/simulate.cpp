#include "tools/simulate/simulate.h"

#include <algorithm>
#include <filesystem>
#include <limits>

#include "common/base/error.h"
#include "common/base/sha256.h"
#include "common/bus/log_file.h"
#include "common/io/tum.h"
#include "drivers/recording/recording_writer.h"
#include "tools/simulate/building/building.h"
#include "tools/simulate/building/lift_doors.h"
#include "tools/simulate/building/mesh_surface.h"
#include "tools/simulate/scene/scene_file.h"
#include "tools/simulate/scene/scene_source.h"
#include "tools/simulate/sensor/legs_odometry.h"
#include "tools/simulate/sensor/sensor_simulator.h"

namespace sgraphs::simulate {
namespace {

constexpr int64_t kPacketsPerBatch = 754;  // about a second
constexpr int64_t kTruthPeriod_us = 10000;

Session describe(const SimulateOptions& options, const SceneSource& source) {
  Sha256 digest;
  digest.add(source.digest);
  digest.add(static_cast<int64_t>(options.seed));
  digest.add(static_cast<int64_t>(options.with_odometry));
  Session session;
  session.config_digest = digest.hex();
  // 60 bits of the digest, and never 0: the same recording has the same session whenever it is made.
  session.id = std::stoll(session.config_digest.substr(0, 15), nullptr, 16) | 1;
  session.start = source.scene.start;
  session.writer = "sgraphs simulate " SGRAPHS_VERSION;
  session.has_odometry = options.with_odometry;
  session.T_body_lidar = source.scene.T_body_lidar;
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

// What the sensors say, merged in the order in which it reaches the host.
class Recorder {
 public:
  Recorder(RecordingWriter& writer, const Scene& scene, std::vector<BodyOdometry> odometry, uint64_t seed)
      : writer_(writer),
        faults_(scene.faults, seed, scene.start),
        odometry_(std::move(odometry)),
        clock_offset_(Duration::fromSeconds(scene.legs.clock_offset_s)) {}

  void add(const SensorPacket& packet) {
    addOdometryBefore(packet.time);
    write(faults_.step(packet));
  }

  void finish() {
    write(faults_.finish());
    addOdometryBefore(Time{std::numeric_limits<int64_t>::max()});
    writer_.finish();
  }

  int64_t packets() const { return packets_; }
  const FaultCounts& faults() const { return faults_.counts(); }

 private:
  void addOdometryBefore(Time time) {
    for (; next_ < odometry_.size(); ++next_) {
      const Time arrived = odometry_[next_].time - clock_offset_;
      if (arrived >= time) return;
      writer_.addOdometry(odometry_[next_], arrived);
    }
  }
  void write(const std::vector<SensorPacket>& arriving) {
    for (const SensorPacket& packet : arriving) writer_.addPacket({packet.time, packet.bytes});
    packets_ += static_cast<int64_t>(arriving.size());
  }

  RecordingWriter& writer_;
  FaultInjector faults_;
  std::vector<BodyOdometry> odometry_;
  size_t next_ = 0;  // of odometry_
  Duration clock_offset_;
  int64_t packets_ = 0;
};

void record(Recorder& recorder, const SensorSimulator& sensor, int num_threads, const Progress& progress) {
  const int64_t total = sensor.numPackets();
  for (int64_t first = 0; first < total; first += kPacketsPerBatch) {
    const int64_t count = std::min(kPacketsPerBatch, total - first);
    for (const SensorPacket& packet : sensor.packets(first, count, num_threads)) recorder.add(packet);
    const double packet_s = vlp16::kPacketPeriod_us * 1e-6;
    if (progress)
      progress(static_cast<double>(first + count) * packet_s, static_cast<double>(total) * packet_s);
  }
  recorder.finish();
}

std::string describeBuilding(const SceneSource& source) {
  if (source.imported.triangles.empty()) return source.scene.name;
  return source.scene.name + " (mesh of " + std::to_string(source.imported.triangles.size()) + " triangles)";
}

}  // namespace

SimulateResult simulate(const SimulateOptions& options, const Progress& progress) {
  if (options.num_threads < 1) throw UsageError("--threads must be at least 1");
  const SceneSource source = openScene({options.scene, options.waypoints, options.overrides});
  const Scene& scene = source.scene;
  TriangleMesh mesh = buildMesh(scene);
  append(mesh, source.imported);
  const RayCaster caster(mesh, buildGlass(scene));
  const double floor_z_m = scene.floors_z_m[static_cast<size_t>(scene.path_floor)];
  const Trajectory trajectory = walkAlong(scene.path, scene.start, floor_z_m);
  const LiftDoors doors(scene, trajectory.rides(), floor_z_m);
  const SensorSimulator sensor(caster, trajectory, scene.T_body_lidar, scene.sensor, options.seed,
                               People(scene.people, scene.floors_z_m), doors);
  std::vector<BodyOdometry> odometry;
  if (options.with_odometry) odometry = simulateLegsOdometry(trajectory, scene.legs, options.seed);
  const auto num_odometry = static_cast<int64_t>(odometry.size());

  append(mesh, doors.closed());
  if (!options.truth_dir.empty()) writeTruth(options.truth_dir, scene, mesh, trajectory);
  LogWriter log(options.output);
  RecordingWriter writer(log, describe(options, source));
  Recorder recorder(writer, scene, std::move(odometry), options.seed);
  record(recorder, sensor, options.num_threads, progress);
  log.close();

  return {trajectory.duration().seconds(),
          lengthOf(sampleTruth(trajectory)),
          recorder.packets(),
          num_odometry,
          recorder.faults(),
          describeBuilding(source),
          source.warnings};
}

}  // namespace sgraphs::simulate
