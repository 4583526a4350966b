#include "backend/output/summary_json.h"

#include <nlohmann/json.hpp>

namespace sgraphs {

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
    json["stages"][name] = {{"p50_ms", t.p50_ms}, {"p99_ms", t.p99_ms}, {"count", t.count}};
  json["factors"] = Json::object();
  for (const auto& [kind, f] : record.factors)
    json["factors"][kind] = {{"count", f.count}, {"dof", f.dof}, {"chi2", f.chi2}};
  json["gaps"] = Json::object();
  for (const auto& [channel, count] : record.gaps) json["gaps"][channel] = count;
  return json.dump(2) + "\n";
}

}  // namespace sgraphs
