#include "tools/run/run_session.h"

#include <algorithm>
#include <utility>

#include "common/base/error.h"
#include "common/bus/log_file.h"
#include "drivers/session_source.h"
#include "lcmtypes/convert/convert.h"
#include "tools/system/stages.h"

namespace sgraphs {
namespace {

Session sessionOfLog(const std::string& path) {
  LogReader reader(path);
  while (const std::optional<LogEvent> event = reader.next()) {
    session_t m{};
    if (event->channel != channels::kSession.name || !decode(event->bytes, m)) continue;
    if (const std::optional<Session> session = fromMessage(m)) return *session;
  }
  throw Error("log '" + path +
              "' holds no SESSION of this version: make one with `sgraphs convert` or `sgraphs simulate`");
}

}  // namespace

Session sessionOf(const RunOptions& options, Time now) {
  Session session;
  if (!options.log.empty()) {
    session = sessionOfLog(options.log);
  } else {
    SessionConfig config = options.config.drivers.session;
    if (!options.T_body_lidar.empty()) config.T_body_lidar = options.T_body_lidar;
    session = liveSession(config, "", "", now);
    session.has_odometry = !options.spot_host.empty();
    // Where there is a robot its odometry is used.
    if (session.has_odometry && session.odometry_mode == toString(OdometryMode::kLidar))
      session.odometry_mode.clear();
  }
  session.writer = "sgraphs run " SGRAPHS_VERSION;
  session.stages = allStages();
  session.stages.emplace_back(BackendNode::kScheduleStage);
  if (!options.odometry.empty()) session.odometry_mode = toString(parseOdometryMode(options.odometry));
  if (session.odometryMode() != OdometryMode::kLidar && !session.has_odometry)
    throw UsageError("odometry mode '" + toString(session.odometryMode()) +
                     "' needs the odometry of legs: give the robot with --spot, or use --odometry lidar");
  session.config_digest = digestOf(options.config);
  return session;
}

RunSession::RunSession(Bus& bus, Session session)
    : bus_(bus), session_(std::move(session)), publisher_(bus), newest_(session_.start) {
  publisher_.setSession(session_.id);
}

void RunSession::publishSession(Time now) {
  session_t m = toMessage(session_, now);
  publisher_.send(channels::kSession, m);
}

void RunSession::heard(const std::string& channel, const header_t& header) {
  if (header.session != session_.id) return;
  last_seq_[channel] = header.seq;
  newest_ = std::max(newest_, Time{header.utime});
}

void RunSession::publishEnd(const std::string& why_not) {
  if (!end_) {
    stream_end_t m{};
    m.header.utime = newest_.us;
    m.why_not = why_not;
    publisher_.addTo(m, channels::kSession.name);
    for (const auto& [channel, seq] : last_seq_) {
      m.channel.push_back(channel);
      m.last_seq.push_back(seq);
    }
    m.num_channels = static_cast<int32_t>(m.channel.size());
    publisher_.send(channels::kStreamEnd, m);
    end_ = std::move(m);
    return;
  }
  publish(bus_, channels::kStreamEnd, *end_);
}

}  // namespace sgraphs
