#pragma once

#include "backend/backend_config.h"
#include "common/config/config_io.h"
#include "perception/free_space/free_space_config.h"
#include "perception/loops/loops_config.h"
#include "perception/odometry/odometry_config.h"
#include "perception/planes/planes_config.h"
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
  BackendConfig backend;
  LiveConfig live;

  void visit(ConfigVisitor& v) {
    v.section("odometry", odometry, "Scans to poses and keyframes");
    v.section("planes", planes, "Keyframe clouds to planes");
    v.section("free_space", free_space, "Keyframe clouds and the optimised map to free space");
    v.section("rooms", rooms, "Free space and walls to rooms, doorways and floors");
    v.section("loops", loops, "Keyframe clouds and the optimised map to loop closures");
    v.section("backend", backend, "Observations to one optimised graph");
    v.section("live", live, "Running live (`sgraphs-backend --live`, `sgraphs run`)");
  }
};

// Identity of a configuration: all keys and values but those that change no result: the number of threads,
// and the deadline of a live run, whose every effect ROUND_SCHEDULE records.
inline std::string digestOf(SystemConfig config) {
  config.odometry.threads = OdometryConfig{}.threads;
  config.live = LiveConfig{};
  return configDigest(visitOf(config));
}

}  // namespace sgraphs
