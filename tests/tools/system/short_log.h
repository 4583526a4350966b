#pragma once

#include <functional>
#include <string>

#include "common/bus/log_file.h"
#include "drivers/recording/recording_writer.h"
#include "tools/simulate/scene/test_worlds.h"
#include "tools/simulate/sensor/legs_odometry.h"

namespace sgraphs::testing {

// Records a robot that walks 3 m through a furnished room, with the odometry of its legs: about 8 s.
inline void writeShortLog(const std::string& path, const std::string& odometry_mode = "") {
  simulate::Scene scene = simulate::makeBoxRoom(7.0, 5.0);
  scene.boxes.push_back({"cupboard", {5.5, 4.2}, {1.2, 0.8}, 0, 1.8, 0.3});
  scene.path.waypoints = {{{1.5, 2.5}, 0}, {{4.5, 2.2}, 0}};
  scene.path.start_pause_s = 1;
  scene.path.end_pause_s = 0.5;
  const simulate::SimulatedWorld world(scene);
  const simulate::Trajectory trajectory = simulate::walkAlong(scene.path, scene.start, 0.0);
  const simulate::SensorSimulator sensor(world.caster, trajectory, scene.T_body_lidar, scene.sensor, 5);
  const std::vector<BodyOdometry> samples = simulate::simulateLegsOdometry(trajectory, {}, 5);

  Session session;
  session.id = 4711;
  session.start = scene.start;
  session.writer = "test";
  session.odometry_mode = odometry_mode;
  session.has_odometry = true;
  session.T_body_lidar = scene.T_body_lidar;
  LogWriter log(path);
  RecordingWriter writer(log, session);
  auto sample = samples.begin();
  for (const simulate::SensorPacket& packet : sensor.packets(0, sensor.numPackets(), 2)) {
    for (; sample != samples.end() && sample->time < packet.time; ++sample) writer.addOdometry(*sample);
    writer.addPacket({packet.time, packet.bytes});
  }
  for (; sample != samples.end(); ++sample) writer.addOdometry(*sample);
  writer.finish();
  log.close();
}

// Copies a log, event by event; `keep` says which (index of the event within its channel, from 0).
inline void copyLog(const std::string& from, const std::string& to,
                    const std::function<bool(const LogEvent&, int index)>& keep) {
  LogReader reader(from);
  LogWriter writer(to);
  std::map<std::string, int> index;
  while (const auto event = reader.next())
    if (keep(*event, index[event->channel]++))
      writer.write(event->timestamp_us, event->channel, event->bytes);
  writer.close();
}

}  // namespace sgraphs::testing
