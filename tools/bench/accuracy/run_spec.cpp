#include "tools/bench/accuracy/run_spec.h"

#include <algorithm>
#include <stdexcept>

namespace sgraphs::bench {
namespace {

constexpr const char* kBaselines[] = {"legs", "gicp", "ndt", "graph"};

void addOurs(TableSpec& table, const std::string& odometry, const std::string& figure,
             const std::vector<std::string>& layers) {
  for (const std::string& layer : layers)
    table.rows.push_back({"sgraphs, --layers " + layer, odometry + "-" + layer, figure});
}

}  // namespace

std::vector<std::string> filledLayers() {
  return {"keyframes", "walls", "rooms", "floors"};
}

TableSpec ateTable(const std::vector<std::string>& layers, bool baselines, std::vector<std::string> scenes) {
  if (scenes.empty()) scenes = {"cf1", "cf2", "se1", "se2"};
  TableSpec table{"ate", "ATE [m], LiDAR only", "", std::move(scenes), {}};
  table.rows.push_back({"sgraphs, odometry alone", "lidar-keyframes", "odometry_ate_m"});
  addOurs(table, "lidar", "ate_m", layers);
  if (!baselines) return table;
  table.rows.push_back({"PCL GICP, scan to keyframe", "lidar-gicp", "ate_m"});
  table.rows.push_back({"PCL NDT, scan to keyframe", "lidar-ndt", "ate_m"});
  table.rows.push_back({"PCL GICP with a pose graph", "lidar-graph", "ate_m"});
  return table;
}

TableSpec mapTable(const std::vector<std::string>& layers, bool baselines, std::vector<std::string> scenes) {
  if (scenes.empty()) scenes = {"cf1", "cf2", "lc1"};
  TableSpec table{"map", "Map RMSE [m], encoder odometry", "map_completeness", std::move(scenes), {}};
  table.rows.push_back({"legs' odometry alone", "encoder-legs", "map_rmse_m"});
  addOurs(table, "encoder", "map_rmse_m", layers);
  if (!baselines) return table;
  table.rows.push_back({"PCL GICP, scan to keyframe, legs as guess", "encoder-gicp", "map_rmse_m"});
  table.rows.push_back({"PCL NDT, scan to keyframe, legs as guess", "encoder-ndt", "map_rmse_m"});
  table.rows.push_back({"legs in a pose graph, loops by PCL GICP", "encoder-graph", "map_rmse_m"});
  return table;
}

RunSpec runSpec(const std::string& id) {
  const size_t dash = id.find('-');
  if (dash == std::string::npos) throw std::logic_error("no run '" + id + "'");
  const std::string odometry = id.substr(0, dash), what = id.substr(dash + 1);
  const bool baseline = std::find(std::begin(kBaselines), std::end(kBaselines), what) != std::end(kBaselines);
  return {id, odometry, baseline ? "" : what, baseline ? what : ""};
}

std::vector<std::string> runsOf(const TableSpec& table) {
  std::vector<std::string> runs;
  for (const RowSpec& row : table.rows)
    if (std::find(runs.begin(), runs.end(), row.run) == runs.end()) runs.push_back(row.run);
  return runs;
}

}  // namespace sgraphs::bench
