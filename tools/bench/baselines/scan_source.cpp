#include "tools/bench/baselines/scan_source.h"

#include <algorithm>

#include "common/base/error.h"
#include "common/bus/log_file.h"
#include "common/bus/memory_bus.h"
#include "tools/system/stages.h"

namespace sgraphs::bench {
namespace {

// Between the samples around the scan's end; the newest one where the recording has no later.
SE3 legsAt(Time end, std::span<const BodyOdometry> samples) {
  const auto after =
      std::find_if(samples.begin(), samples.end(), [&](const BodyOdometry& s) { return s.time >= end; });
  if (after == samples.end()) return samples.back().T_odom_body;
  if (after == samples.begin()) return after->T_odom_body;
  const BodyOdometry& before = *(after - 1);
  const double share =
      static_cast<double>((end - before.time).us) / static_cast<double>((after->time - before.time).us);
  return interpolate(before.T_odom_body, after->T_odom_body, share);
}

}  // namespace

void forEachScan(const std::string& log, bool with_legs,
                 const std::function<void(const RecordedScan&)>& visit) {
  OdometryParts parts = makeOdometryParts(SystemConfig{});
  bool has_session = false;
  parts.make_step = [&](OdometryMode, const SE3& T_body_lidar) {
    has_session = true;
    const auto show = [&visit, with_legs, T_body_lidar](const LidarScan& scan,
                                                        std::span<const BodyOdometry> samples) {
      RecordedScan recorded{scan, T_body_lidar, std::nullopt};
      if (with_legs && !samples.empty()) recorded.T_odom_body = legsAt(scan.end, samples);
      if (!with_legs || recorded.T_odom_body) visit(recorded);
      return std::optional<OdometryEstimate>{};
    };
    return OdometryParts::Step{show};
  };
  MemoryBus bus;
  OdometryNode node(bus, std::move(parts), with_legs ? "encoder" : "lidar");
  LogReader reader(log);
  while (const std::optional<LogEvent> event = reader.next()) {
    const channels::Row* row = channels::find(event->channel.c_str());
    if (!row || !row->raw) continue;
    bus.publish(event->channel, event->bytes);
    bus.dispatch(0);
  }
  if (!has_session)
    throw Error("log '" + log + "' holds no SESSION: make one with `sgraphs simulate` or `sgraphs convert`");
  if (!node.done()) node.finish("");
}

}  // namespace sgraphs::bench
