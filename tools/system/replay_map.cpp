// The part of Replay that continues an earlier map.
#include <spdlog/fmt/fmt.h>

#include <utility>

#include "common/base/error.h"
#include "lcmtypes/convert/convert.h"
#include "tools/system/replay.h"

namespace sgraphs {

void Replay::loadMap() {
  const Stopwatch watch;
  if (map_log_) map_log_->setShift([this] { return loaded_.shift; });
  earlier_->read([&](const LogEvent& event, double share) {
    session_t session{};
    keyframe_t keyframe{};
    if (event.channel == channels::kOdometryEnd.name) return restAfter(event);
    if (event.channel == channels::kSession.name && decode(event.bytes, session)) {
      loaded_.session = session.header.session;
      publish(bus_, channels::kSession, withStages(session));
      bus_.dispatch(0);
      return;
    }
    if (event.channel == channels::kOdometry.name && decode(event.bytes, loaded_.last))
      sessionBegins(loaded_.last, event);
    else if (event.channel == channels::kKeyframe.name && decode(event.bytes, keyframe))
      sessionBegins(keyframe, event);
    publishOnMap(event.channel, event.bytes);
    if (options_.on_progress) options_.on_progress({true, share, 0, watch.elapsedSeconds()});
  });
  loaded_.keyframes = static_cast<int64_t>(backend_->graph().keyframes.size());
  loaded_.graph_digest = backend_->graphDigest();
  loaded_.wall_s = watch.elapsedSeconds();
  const std::string dir = "map '" + earlier_->dir() + "'";
  if (loaded_.keyframes == 0) throw Error(dir + " holds no keyframe: replay its recording again");
  if (loaded_.graph_digest == earlier_->graphDigest()) return;
  const std::string config = digestOf(options_.config);
  warnings_.push_back(
      config != earlier_->configDigest()
          ? fmt::format(
                "{} was made with another configuration (config_digest {:.12}, now {:.12}): it is made "
                "again with this one",
                dir, earlier_->configDigest(), config)
          : fmt::format(
                "{} comes out otherwise than its summary.json says (graph_digest {:.12}, now {:.12}): "
                "it was made by another version ({}), with other --layers, or was damaged",
                dir, earlier_->graphDigest(), loaded_.graph_digest, earlier_->version()));
}

// ODOMETRY or KEYFRAME of a session's first scan, whichever the log has first.
template <typename Message>
void Replay::sessionBegins(const Message& m, const LogEvent& event) {
  if (!std::exchange(loaded_.between_sessions, false)) return;
  loaded_.shift = Duration{m.header.utime - event.timestamp_us};
  loaded_.sessions.push_back({KeyframeId{m.keyframe}, Time{m.header.utime}, loaded_.shift});
}

// A session of the map is over: the run that it was ended with these rounds.
void Replay::restAfter(const LogEvent& end) {
  backend_->rest();
  bus_.dispatch(0);
  if (backend_->resting())
    throw Error("map '" + earlier_->dir() + "/" + kMapLogName +
                "' lacks messages of a session: it is damaged; replay its recording again");
  if (map_log_) map_log_->write(end.channel, end.bytes);
  loaded_.between_sessions = true;
}

MapEnd Replay::mapEnd() const {
  MapEnd end;
  end.session = loaded_.session;
  end.boot = loaded_.last.header.boot;
  for (const auto& [channel, count] : backend_->gate().counts()) end.last_seq[channel] = count.last_seq;
  end.keyframe = KeyframeId{loaded_.last.keyframe};
  end.scan = loaded_.last.scan;
  end.time = Time{loaded_.last.header.utime};
  end.T_map_odom = backend_->T_map_odom();
  return end;
}

void Replay::connectRelocaliser() {
  std::vector<MapView> views;
  for (const auto& [id, node] : backend_->graph().keyframes)
    if (node.keyframe) views.push_back({node.keyframe.get(), node.T_map_body, node.floor});
  relocaliser_ = std::make_shared<Relocaliser>(options_.config.relocalise, options_.config.loops, views);
  relocalise_.emplace(
      session_bus_, bus_, mapEnd(),
      [r = relocaliser_](const Keyframe& keyframe) { return r->step(keyframe); },
      [r = relocaliser_] { return r->lost(); });
  // Until the robot is found nothing is written of its session.
  if (map_log_) map_log_->setShift([this] { return relocalise_->joiner().shift(); });
}

void Replay::requireFound() const {
  if (relocalise_->found()) return;
  throw Error(
      fmt::format("the robot was not found in map '{}' within {:.1f} m of walking ({}): walk on through "
                  "places that the map "
                  "knows, or replay the log without --map for a map of its own",
                  earlier_->dir(), relocaliser_->walked_m(), relocaliser_->describe()));
}

RunRecord::Continued Replay::continued() const {
  const RelocaliseNode::Found& found = *relocalise_->found();
  const SessionJoiner& joiner = relocalise_->joiner();
  RunRecord::Continued c;
  c.graph_digest = earlier_->graphDigest();
  c.same = loaded_.graph_digest == earlier_->graphDigest();
  c.keyframes = loaded_.keyframes;
  c.load_s = loaded_.wall_s;
  c.walked_m = found.at.walked_m;
  c.after_s = found.after.seconds();
  c.looks = found.at.looks;
  c.matched = found.at.anchor;
  c.T_mapodom_odom = joiner.T_mapodom_odom();
  c.sessions = loaded_.sessions;
  const KeyframeId first = joiner.firstKeyframe();
  c.sessions.push_back({first, backend_->graph().keyframes.at(first).time, joiner.shift()});
  return c;
}

}  // namespace sgraphs
