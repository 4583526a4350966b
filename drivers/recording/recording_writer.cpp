#include "drivers/recording/recording_writer.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/bus/channels.h"
#include "drivers/velodyne/vlp16_packet.h"

namespace sgraphs {
namespace {

constexpr Duration kSessionInterval{1'000'000};
constexpr Duration kMaxFilledGap{10'000'000};

Time lastFiring(const VelodynePacket& packet) {
  Vlp16Packet parsed;
  // A packet that does not parse is recorded all the same: whoever decodes the log refuses and counts it.
  if (parsePacket(packet.bytes, parsed) != PacketFault::kNone) return packet.time;
  return packet.time + Duration{std::llround(parsed.lastFiring_us())};
}

}  // namespace

RecordingWriter::RecordingWriter(LogWriter& log, const Session& session)
    : log_(log), session_(session), next_session_(session.start), now_(session.start) {
  if (session.id == 0) throw std::logic_error("RecordingWriter: a session's id is never 0");
  tick(session.start);
}

void RecordingWriter::tick(Time now) {
  // A gap in the recording is not filled with repetitions.
  if (now - next_session_ > kMaxFilledGap) next_session_ = now;
  while (next_session_ <= now) {
    session_t message = toMessage(session_, next_session_);
    message.header = header(channels::kSession.name, next_session_);
    now_ = std::max(now_, next_session_);
    write(log_, now_.us, channels::kSession, message);
    next_session_ = next_session_ + kSessionInterval;
  }
  now_ = std::max(now_, now);
}

header_t RecordingWriter::header(const std::string& channel, Time time) {
  header_t header{};
  header.session = session_.id;
  header.seq = next_seq_[channel]++;
  header.utime = time.us;
  return header;
}

void RecordingWriter::addPacket(const VelodynePacket& packet) {
  if (const auto group = grouper_.step(packet)) writePackets(*group);
}

void RecordingWriter::writePackets(const PacketGroup& group) {
  tick(lastFiring(group.packets.back()));
  velodyne_packets_t message = toMessage(group.packets, group.revolution, group.part, group.last_part);
  message.header = header(channels::kVelodynePackets.name, group.packets.front().time);
  write(log_, now_.us, channels::kVelodynePackets, message);
}

void RecordingWriter::addScan(const LidarScan& scan) {
  tick(scan.end);
  for (lidar_points_t& message : toMessages(scan)) {
    message.header = header(channels::kLidarPoints.name, scan.end);
    write(log_, now_.us, channels::kLidarPoints, message);
  }
}

void RecordingWriter::addOdometry(const BodyOdometry& odometry, Time arrived) {
  tick(arrived);
  spot_odometry_t message = toMessage(odometry);
  message.header = header(channels::kSpotOdometry.name, odometry.time);
  write(log_, now_.us, channels::kSpotOdometry, message);
  if (odometry.twist_body)
    write(log_, now_.us, channels::kPoseSpot,
          toPoseMessage(odometry.time, odometry.T_odom_body, *odometry.twist_body));
}

void RecordingWriter::finish() {
  if (const auto group = grouper_.flush()) writePackets(*group);
  stream_end_t message{};
  for (const auto& [channel, next] : next_seq_) {
    message.channel.push_back(channel);
    message.last_seq.push_back(next - 1);
  }
  message.num_channels = static_cast<int32_t>(message.channel.size());
  message.header = header(channels::kStreamEnd.name, now_);
  write(log_, now_.us, channels::kStreamEnd, message);
}

}  // namespace sgraphs
