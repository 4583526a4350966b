#pragma once

#include <string>
#include <vector>

namespace sgraphs::bench {

// One program's run on a log: what stands behind a row of a table.
struct RunSpec {
  std::string id;        // "lidar-walls", "encoder-gicp"
  std::string odometry;  // "lidar" or "encoder"
  std::string layers;    // of `sgraphs replay`; empty: a baseline
  std::string baseline;  // of `sgraphs bench baseline`; empty: ours
};

// A row of a table: a figure of a run.
struct RowSpec {
  std::string title;
  std::string run;     // id of RunSpec
  std::string figure;  // name in RunResult
};

struct TableSpec {
  std::string id;  // "ate", "map", "scenes"
  std::string title;
  std::string completeness_figure;  // a figure that is shown beside each value; empty: none
  std::vector<std::string> scenes;
  std::vector<RowSpec> rows;
};

// Layers that `sgraphs replay --layers` fills in this version, lowest first.
std::vector<std::string> filledLayers();

// The paper's two tables with our rows and the baselines'; `scenes` empty: the paper's.
TableSpec ateTable(const std::vector<std::string>& layers, bool baselines, std::vector<std::string> scenes);
TableSpec mapTable(const std::vector<std::string>& layers, bool baselines, std::vector<std::string> scenes);

// What `id` stands for; throws std::logic_error if no table has such a run.
RunSpec runSpec(const std::string& id);

// Runs behind a table's rows, each once, in the rows' order.
std::vector<std::string> runsOf(const TableSpec& table);

}  // namespace sgraphs::bench
