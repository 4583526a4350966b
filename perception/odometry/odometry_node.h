#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/performance.h"
#include "common/bus/bus.h"
#include "common/bus/channels.h"
#include "common/bus/input_gate.h"
#include "common/bus/publisher.h"
#include "lcmtypes/convert/convert.h"
#include "perception/odometry/clock_offset.h"
#include "perception/odometry/odometry.h"
#include "perception/odometry/scan_queue.h"

namespace sgraphs {

// The cores that the node drives. Both are made when SESSION arrives, which says how the LiDAR is mounted.
struct OdometryParts {
  // A packet in, the revolution that it completes out.
  using Decode = std::function<std::optional<LidarScan>(const VelodynePacket&)>;
  struct Step {  // as Odometry has them
    std::function<std::optional<OdometryEstimate>(const LidarScan&, std::span<const BodyOdometry>)> scan;
    std::function<std::optional<Keyframe>()> take_keyframe = {};  // empty: there are none
  };
  std::function<Decode()> make_decoder;
  std::function<Step(OdometryMode, const SE3& T_body_lidar)> make_step;
  // State of the decoder and the step that were made last; empty: it cannot be saved.
  std::function<void(StateArchive&)> visit_state;
  ClockOffsetConfig clock;
};

// Odometry on a bus: SESSION, VELODYNE_PACKETS or LIDAR_POINTS, SPOT_ODOMETRY, STREAM_END in; ODOMETRY,
// POSE_ODOM, KEYFRAME, ODOMETRY_END out. What it computes depends on its inputs' content and order alone.
//
// Of one scan it publishes first ODOMETRY and POSE_ODOM, for which a robot waits, then the chunks of KEYFRAME
// if the scan became one: whoever hears ODOMETRY knows that all keyframes of earlier scans were sent before.
class OdometryNode {
 public:
  // odometry_override: "lidar", "encoder" or "fused" in place of SESSION's; empty keeps SESSION's. The bus
  // must outlive the node. Throws UsageError for another word.
  OdometryNode(Bus& bus, OdometryParts parts, const std::string& odometry_override = "");

  // Ends a stream that has no STREAM_END: works off what is held and publishes ODOMETRY_END. `why_not`: why
  // another run may differ; empty if it may not.
  void finish(const std::string& why_not);

  // All that the node knows of its inputs so far, for a process that is killed and comes back; an archive
  // that reads belongs to a node that has heard nothing. Not possible before SESSION, within a sweep of
  // several chunks, and when done.
  bool canSave() const { return session_message_ && sweep_.empty() && !done() && parts_.visit_state; }
  void visitState(StateArchive& archive);

  void publishStatus();
  // Sends ODOMETRY_END once more, for a reader that lost it (same sequence number).
  void repeatEnd();

  bool done() const { return end_.has_value(); }
  // Why this run is not reproducible; empty if it is. Known once done.
  std::string whyNot() const { return end_ ? end_->why_not : ""; }

  const InputGate& gate() const { return gate_; }
  const LatencyHistogram& decodeLatency() const { return decode_latency_; }
  const LatencyHistogram& stepLatency() const { return step_latency_; }
  Duration duration() const;                 // sensor time from the first to the last input
  Time now() const { return newest_time_; }  // newest sensor time seen
  int64_t scans() const { return scans_; }
  // Of the legs' clock against the LiDAR's; nothing where it is not estimated (mode fused only), or not yet.
  std::optional<ClockOffset::Estimate> legsClock() const;
  Duration legsClockInForce() const { return clock_ ? clock_->inForce() : Duration{}; }
  // What went otherwise than planned without being lost or refused: kind -> count.
  const std::map<std::string, int64_t>& oddities() const { return oddities_; }

 private:
  void onSession(const session_t& m);
  void begin(const session_t& m, Session session);
  void onPackets(const velodyne_packets_t& m);
  void onPoints(const lidar_points_t& m);
  void onSpotOdometry(const spot_odometry_t& m);
  void onStreamEnd(const stream_end_t& m);

  bool enter(const std::string& channel, const header_t& header);
  bool plausible(const std::string& channel, Time time);
  void addScan(const std::string& channel, LidarScan scan);
  void workOff();
  void publishScan(const OdometryEstimate& estimate);
  void followClock(const OdometryEstimate& estimate);
  std::string state() const;

  Publisher publisher_;
  Bus& bus_;
  OdometryParts parts_;
  std::string odometry_override_;
  InputGate gate_;

  std::optional<session_t> session_message_;  // that began the session, as it came
  std::optional<Session> session_;
  OdometryMode mode_ = OdometryMode::kLidar;
  OdometryParts::Decode decode_;
  OdometryParts::Step step_;
  ScanQueue queue_{false};
  std::optional<ClockOffset> clock_;
  std::vector<lidar_points_t> sweep_;  // chunks so far of the sweep being assembled
  Time first_time_, newest_time_;      // of the sensors; SESSION's start until one is heard
  bool heard_ = false;
  Time newest_packet_;

  std::optional<stream_end_t> end_;
  int64_t scans_ = 0;
  std::map<std::string, int64_t> oddities_;
  LatencyHistogram decode_latency_, step_latency_;
};

}  // namespace sgraphs
