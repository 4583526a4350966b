#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/types/keyframe.h"
#include "sgraphs/keyframe_planes_t.hpp"
#include "sgraphs/keyframe_t.hpp"
#include "sgraphs/odometry_t.hpp"
#include "sgraphs/stream_end_t.hpp"

namespace sgraphs {

// Where the messages of a map end: what those of a new session are to follow.
struct MapEnd {
  int64_t session = 0;
  int64_t boot = 0;
  std::map<std::string, int64_t> last_seq;  // per channel
  KeyframeId keyframe;                      // newest
  int64_t scan = -1;                        // newest
  Time time;                                // of the newest scan, by the map's clock
  SE3 T_map_odom;                           // after the last round
};

// The first keyframe of a new session, measured from one of the map.
struct SessionStart {
  KeyframeId anchor;
  SE3 T_anchor_first;
  Matrix6d covariance = Matrix6d::Identity();
  SE3 T_map_odom;  // odom of the new session
};

// Makes a session's messages the continuation of a map's: session, numbers, ids of keyframes and scans go on
// after the map's last ones; stamps too, by one shift if the session's clock is not behind the map's; poses
// in odom are moved into the map's odom, so that the way from the map's last keyframe to the first new one is
// a step of the odometry; and that first one gets the measurement that ties it to the map. Messages that came
// before the robot was found are held back, and follow then, in order.
class SessionJoiner {
 public:
  // What goes on to the map's stages.
  struct Sink {
    std::function<void(const odometry_t&)> odometry;
    std::function<void(const keyframe_t&)> keyframe;
    std::function<void(const keyframe_planes_t&)> planes;
    std::function<void(const stream_end_t&)> odometry_end, planes_end;
  };

  SessionJoiner(const MapEnd& map, Sink sink);

  void add(const odometry_t& m);
  void add(const keyframe_t& m);
  void add(const keyframe_planes_t& m);
  void addOdometryEnd(const stream_end_t& m);
  void addPlanesEnd(const stream_end_t& m);

  // The robot is found: hands out what waits; from now on nothing does.
  void join(const SessionStart& start);
  bool joined() const { return joined_; }
  // Forgets what waits.
  void drop();

  // Id of the new session's first keyframe in the map, and of its first scan.
  KeyframeId firstKeyframe() const { return {map_.keyframe.value + 1}; }
  int64_t firstScan() const { return map_.scan + 1; }
  // What is added to the session's stamps, and its odom in the map's: valid once joined.
  Duration shift() const { return shift_; }
  const SE3& T_mapodom_odom() const { return T_mapodom_odom_; }
  size_t heldBytes() const { return held_bytes_; }

 private:
  template <typename Message>
  void pass(const Message& m);
  template <typename Release>
  void passOrHold(size_t bytes, Release release);
  void seen(const header_t& header);
  void continueHeader(header_t& header, const char* channel) const;
  void continuePose(transform_t& T_odom_body) const;
  void release(odometry_t m) const;
  void release(keyframe_t m) const;
  void release(keyframe_planes_t m) const;
  stream_end_t continued(stream_end_t m) const;

  MapEnd map_;
  Sink sink_;
  bool joined_ = false;
  bool has_first_ = false;
  Time first_time_;  // oldest stamp of the session
  SessionStart start_;
  Duration shift_;
  SE3 T_mapodom_odom_;
  std::vector<std::function<void()>> held_;
  size_t held_bytes_ = 0;
};

}  // namespace sgraphs
