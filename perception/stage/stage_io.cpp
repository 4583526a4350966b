#include "perception/stage/stage_io.h"

#include <algorithm>
#include <utility>

#include "lcmtypes/convert/convert.h"

namespace sgraphs {

StageIo::StageIo(Bus& bus, std::string stage, std::string process)
    : bus_(bus), stage_(std::move(stage)), process_(std::move(process)), publisher_(bus) {
  subscribe(
      bus_, channels::kSession, [this](const session_t& m) { onSession(m); },
      [this] { gate_.reject(channels::kSession.name, "undecodable"); });
}

void StageIo::onSession(const session_t& m) {
  const std::string channel = channels::kSession.name;
  if (closed_) return;
  const std::optional<Session> session = fromMessage(m);
  if (!session)
    return gate_.reject(channel, "no session id, another schema, or content that cannot be right");
  if (!gate_.accept(channel, m.header) || session_) return;
  session_ = session;
  publisher_.setSession(session->id);
  const auto& stages = session->stages;
  takes_part_ = stages.empty() || std::find(stages.begin(), stages.end(), stage_) != stages.end();
  early_.open();
}

void StageIo::publishStatus(const Channel<status_t>& channel, Time newest, size_t queue_depth,
                            const LatencyHistogram& latency) {
  const std::string state = closed_       ? "done"
                            : !session_   ? "waiting for SESSION"
                            : takes_part_ ? "running"
                                          : "not a stage of this SESSION";
  status_t status = makeStatus(process_, state, gate_, publisher_, queue_depth, latency);
  status.header.utime = newest.us;
  publisher_.send(channel, status);
}

}  // namespace sgraphs
