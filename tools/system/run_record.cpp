#include "tools/system/run_record.h"

#include <algorithm>

#include "common/base/performance.h"

namespace sgraphs {

RunRecord recordOf(const BackendNode& backend, const SystemConfig& config) {
  RunRecord record;
  record.graph = &backend.graph();
  record.scans = backend.scans();
  record.factors = backend.factors();
  record.keyframe_covariances = backend.covariances();
  record.version = SGRAPHS_VERSION;
  record.config_digest = digestOf(config);
  record.graph_digest = backend.result().graph_digest;
  record.reproducible = backend.result().reproducible != 0;
  record.why_not = backend.result().why_not;
  // SESSION's own stamp may be of another clock.
  if (!record.scans.empty())
    record.duration_s = (record.scans.back().time - record.scans.front().time).seconds();
  record.peak_rss_mib = peakResidentMib();
  record.stages["backend"] = timingOf(backend.roundLatency());
  addGaps(record, backend.gate());
  return record;
}

StageTiming timingOf(const LatencyHistogram& latency) {
  return {static_cast<double>(latency.percentileUs(0.5)) * 1e-3,
          static_cast<double>(latency.percentileUs(0.99)) * 1e-3,
          static_cast<double>(latency.percentileUs(1.0)) * 1e-3, latency.count()};
}

void addGaps(RunRecord& record, const InputGate& gate) {
  for (const auto& [channel, count] : gate.counts()) {
    if (count.lost == 0) continue;
    int64_t& gap = record.gaps[channel];
    gap = std::max(gap, count.lost);  // two stages may have missed the same message
  }
}

}  // namespace sgraphs
