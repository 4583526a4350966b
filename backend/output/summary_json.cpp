#include "backend/output/summary_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

namespace sgraphs {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return -1;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// How well the scans found the local map; medians are -1 where no scan was registered (encoder mode).
nlohmann::ordered_json registrationJson(const std::vector<OdometryEstimate>& scans) {
  std::vector<double> share, rms;
  int64_t degenerate = 0, extrapolated = 0;
  for (const OdometryEstimate& scan : scans) {
    degenerate += scan.num_degenerate > 0;
    extrapolated += scan.extrapolated;
    if (scan.inlier_share < 0) continue;
    share.push_back(scan.inlier_share);
    rms.push_back(scan.residual_rms_m);
  }
  return {{"scans", share.size()},
          {"inlier_share_p50", median(share)},
          {"residual_rms_m_p50", median(rms)},
          {"degenerate_scans", degenerate},
          {"extrapolated_scans", extrapolated}};
}

}  // namespace

std::string summaryJson(const RunRecord& record) {
  using Json = nlohmann::ordered_json;
  Json json;
  json["version"] = record.version;
  json["config_digest"] = record.config_digest;
  json["input_digest"] = record.input_digest;
  json["graph_digest"] = record.graph_digest;
  json["reproducible"] = record.reproducible;
  json["why_not"] = record.why_not;
  json["duration_s"] = record.duration_s;
  json["wall_s"] = record.wall_s;
  json["realtime_factor"] = record.realtime_factor;
  json["peak_rss_mib"] = record.peak_rss_mib;
  json["stages"] = Json::object();
  for (const auto& [name, t] : record.stages)
    json["stages"][name] = {
        {"p50_ms", t.p50_ms}, {"p99_ms", t.p99_ms}, {"max_ms", t.max_ms}, {"count", t.count}};
  json["registration"] = registrationJson(record.scans);
  json["factors"] = Json::object();
  for (const auto& [kind, f] : record.factors)
    json["factors"][kind] = {{"count", f.count}, {"dof", f.dof}, {"chi2", f.chi2}};
  json["gaps"] = Json::object();
  for (const auto& [channel, count] : record.gaps) json["gaps"][channel] = count;
  if (const auto& clock = record.legs_clock)
    json["legs_clock"] = {
        {"offset_ms", clock->offset_ms}, {"sigma_ms", clock->sigma_ms}, {"in_force_ms", clock->in_force_ms}};
  if (const auto& map = record.continued)
    json["map"] = {{"graph_digest", map->graph_digest},
                   {"same_when_loaded", map->same},
                   {"keyframes", map->keyframes},
                   {"sessions", map->sessions.size() - 1},
                   {"load_s", map->load_s},
                   {"found_after_m", map->walked_m},
                   {"found_after_s", map->after_s},
                   {"looks", map->looks},
                   {"matched", map->matched.str()}};
  return json.dump(2) + "\n";
}

}  // namespace sgraphs
