#pragma once

#include "backend/backend_config.h"
#include "common/config/config_io.h"
#include "drivers/driver_config.h"
#include "perception/free_space/free_space_config.h"
#include "perception/loops/loops_config.h"
#include "perception/odometry/odometry_config.h"
#include "perception/planes/planes_config.h"
#include "perception/relocalise/relocalise_config.h"
#include "perception/rooms/rooms_config.h"
#include "tools/system/live_config.h"

namespace sgraphs {

// Configuration of the whole system: config/sgraphs.yaml holds every key with its default.
struct SystemConfig {
  OdometryConfig odometry;
  PlanesConfig planes;
  FreeSpaceConfig free_space;
  RoomsConfig rooms;
  LoopsConfig loops;
  RelocaliseConfig relocalise;
  BackendConfig backend;
  LiveConfig live;
  DriverConfig drivers;

  void visit(ConfigVisitor& v) {
    visitStages(v);
    v.section("live", live, "Running live (`sgraphs-backend --live`, `sgraphs run`)");
    v.section("drivers", drivers, "The outside world on a robot: what is recorded, not what is made of it");
  }

  // What a result depends on.
  void visitStages(ConfigVisitor& v) {
    v.section("odometry", odometry, "Scans to poses and keyframes");
    v.section("planes", planes, "Keyframe clouds to planes");
    v.section("free_space", free_space, "Keyframe clouds and the optimised map to free space");
    v.section("rooms", rooms, "Free space and walls to rooms, doorways and floors");
    v.section("loops", loops, "Keyframe clouds and the optimised map to loop closures");
    v.section("relocalise", relocalise, "Where in an earlier map the robot is (`sgraphs replay --map`)");
    v.section("backend", backend, "Observations to one optimised graph");
  }
};

// Identity of a configuration: all keys and values of the stages but the number of threads, which changes no
// result. Neither does the deadline of a live run: its every effect stands in ROUND_SCHEDULE.
inline std::string digestOf(SystemConfig config) {
  config.odometry.threads = OdometryConfig{}.threads;
  return configDigest([&config](ConfigVisitor& v) { config.visitStages(v); });
}

}  // namespace sgraphs
