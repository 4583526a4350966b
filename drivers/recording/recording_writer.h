#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/bus/log_file.h"
#include "common/types/lidar_scan.h"
#include "common/types/session.h"
#include "drivers/velodyne/packet_grouper.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs {

// Writes a log that is complete by itself: SESSION first and at 1 Hz, the raw channels in time order,
// STREAM_END last. Items are added in order of time. Packets are collected into messages by PacketGrouper,
// and written at the time of their last firing.
class RecordingWriter {
 public:
  // session.id must not be 0; session.start is the time of the first item.
  RecordingWriter(LogWriter& log, const Session& session);

  void addPacket(const VelodynePacket& packet);
  void addScan(const LidarScan& scan);
  void addOdometry(const BodyOdometry& odometry) { addOdometry(odometry, odometry.time); }
  // A sample whose own clock is not the host's: it stands in the log where it arrived.
  void addOdometry(const BodyOdometry& odometry, Time arrived);
  // Writes what is pending, and STREAM_END.
  void finish();

 private:
  void tick(Time now);
  void writePackets(const PacketGroup& group);
  header_t header(const std::string& channel, Time time);

  LogWriter& log_;
  Session session_;
  Time next_session_;
  Time now_;
  PacketGrouper grouper_;
  std::map<std::string, int64_t> next_seq_;
};

}  // namespace sgraphs
