#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/types/lidar_scan.h"
#include "tools/simulate/building/lift_doors.h"
#include "tools/simulate/building/people.h"
#include "tools/simulate/building/ray_caster.h"
#include "tools/simulate/sensor/sensor_model.h"
#include "tools/simulate/walk/trajectory.h"

namespace sgraphs::simulate {

// A data packet as the sensor sends it (0x37 strongest return, 0x22 VLP-16).
struct SensorPacket {
  Time time;  // of the first firing
  std::array<uint8_t, vlp16::kPacketBytes> bytes{};
};

// A VLP-16 carried along a trajectory: every laser fires at its own instant, from where the sensor is then.
// Firing sequence k begins k * 55.296 us after the trajectory's start; the azimuth advances with time.
// People stand still during a sequence: they move by less than 0.1 mm. Results depend on (building, people,
// trajectory, model, seed) and on the index asked for only, not on the number of
// threads or the order of calls. All methods are safe to call from several threads.
//
// lidar frame (ROS): x forward = R cos(w) cos(az), y left = -R cos(w) sin(az), z up = R sin(w) + the laser's
// offset.
class SensorSimulator {
 public:
  // Keeps references to `building`: it must outlive the simulator.
  SensorSimulator(const RayCaster& building, const Trajectory& trajectory, const SE3& T_body_lidar,
                  const SensorModel& model = {}, uint64_t seed = 0, People people = {}, LiftDoors doors = {});

  // Packets that are complete by the trajectory's end.
  int64_t numPackets() const;
  SensorPacket packet(int64_t index) const;
  // `count` packets from `first` on, made by `num_threads` threads.
  std::vector<SensorPacket> packets(int64_t first, int64_t count, int num_threads) const;

  // Revolutions that are complete by the trajectory's end.
  int64_t numScans() const;
  // The points of revolution `index`, as a decoder would give them, but with exact azimuths.
  LidarScan scan(int64_t index) const;

  // T_building_lidar at an instant, to put points where they were measured.
  SE3 lidarPoseAt(Time time) const {
    return trajectory_.seenPoseAtOffset((time - trajectory_.start()).seconds()) * T_body_lidar_;
  }

 private:
  struct Return {
    double range_m = 0;  // multiple of 2 mm; 0: none
    uint8_t reflectivity = 0;
  };
  struct MovingNow {
    PeopleNow people;
    LiftDoorsNow doors;
  };

  double azimuthDeg(double offset_us) const;  // not wrapped
  std::array<Return, vlp16::kLasers> fire(int64_t sequence) const;
  // What one laser of one firing sequence measures.
  Return measure(int64_t sequence, int laser, const MovingNow& moving, double noise, double chance) const;
  // The surface that sends the ray back: the building's, a person's or a lift's door, or a pane of glass
  // before it.
  std::optional<RayHit> firstReturn(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray,
                                    const MovingNow& moving, uint64_t firing) const;

  const RayCaster& building_;
  Trajectory trajectory_;
  SE3 T_body_lidar_;
  SensorModel model_;
  uint64_t seed_;
  People people_;
  LiftDoors doors_;
  std::array<double, vlp16::kLasers> cos_elevation_;
  std::array<double, vlp16::kLasers> sin_elevation_;
};

// Packets in the hour of their first firing: microseconds past the full hour.
uint32_t microsecondsPastHour(Time time);

}  // namespace sgraphs::simulate
