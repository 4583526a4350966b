#include "tools/bench/accuracy/result_tables.h"

#include <algorithm>
#include <cstdio>
#include <set>

#include "tools/bench/accuracy/printed_values.h"
#include "tools/bench/accuracy/statistics.h"
#include "tools/eval/evaluate.h"

namespace sgraphs::bench {
namespace {

std::string number(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

// Millimetres matter below ten metres.
int digitsOf(double value_m) {
  return value_m < 10 ? 4 : 2;
}

std::string spreadCell(const Spread& spread) {
  const int digits = digitsOf(spread.max);
  std::string cell = number(spread.median, digits);
  if (spread.count > 1) cell += " (" + number(spread.min, digits) + "–" + number(spread.max, digits) + ")";
  return cell;
}

// Of a run cut off the rows may hold fewer seeds than there are.
size_t seedsIn(const std::vector<RunResult>& results) {
  std::set<uint64_t> seeds;
  for (const RunResult& result : results) seeds.insert(result.key.seed);
  return seeds.size();
}

std::string cellOf(const TableSpec& table, const RowSpec& row, const std::string& scene,
                   const std::vector<RunResult>& results) {
  const auto value = spreadOf(results, scene, row.run, row.figure);
  if (!value) return "–";
  std::string cell = spreadCell(*value);
  if (value->count < seedsIn(results)) cell += " [" + std::to_string(value->count) + "]";
  if (table.completeness_figure.empty()) return cell;
  const auto completeness = spreadOf(results, scene, row.run, table.completeness_figure);
  if (!completeness) return cell;
  cell += ", " + number(completeness->median, 2);
  return completeness->median < MapResult::kMinCompleteness ? cell + " *" : cell;
}

struct Column {
  const char* head;
  const char* figure;
  int digits;
};
constexpr Column kDetails[] = {
    {"ATE [m]", "ate_m", 4},
    {"coverage", "time_coverage", 4},
    {"map RMSE [m]", "map_rmse_m", 4},
    {"completeness", "map_completeness", 2},
    {"walls asked", "walls_asked", 0},
    {"missed", "walls_missed", 0},
    {"doubled", "walls_doubled", 0},
    {"false", "walls_false", 0},
    {"room precision", "room_precision", 2},
    {"recall", "room_recall", 2},
    {"NEES of poses: translation", "pose_nees_translation", 2},
    {"rotation", "pose_nees_rotation", 2},
    {"× real time", "realtime_factor", 1},
    {"scan p50 [ms]", "odometry_p50_ms", 1},
    {"baseline's scan p50 [ms]", "baseline_p50_ms", 0},
    {"CPU [s]", "cpu_s", 1},
    {"memory [MiB]", "peak_rss_mib", 0},
};

// Characters, not bytes: the tables hold dashes of three bytes.
size_t width(const std::string& text) {
  return static_cast<size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

Cells resultCells(const TableSpec& table, const std::vector<RunResult>& results) {
  Cells cells{{"method"}};
  for (const std::string& scene : table.scenes) cells[0].push_back(scene);
  for (const RowSpec& row : table.rows) {
    cells.push_back({row.title});
    for (const std::string& scene : table.scenes) cells.back().push_back(cellOf(table, row, scene, results));
  }
  return cells;
}

Cells printedCells(const TableSpec& table) {
  const auto printed = printedTable(table.id);
  if (!printed) return {};
  Cells cells{{"method"}};
  for (const char* scene : printed->scenes) cells[0].push_back(scene);
  for (const PrintedRow& row : printed->rows) {
    cells.push_back({row.system});
    for (size_t i = 0; i < printed->scenes.size(); ++i)
      cells.back().push_back(row.values[i] < 0 ? "–" : number(row.values[i], 2));
  }
  return cells;
}

std::string printedCaption(const TableSpec& table) {
  const auto printed = printedTable(table.id);
  return printed ? printed->caption : "";
}

Cells detailCells(const std::vector<TableSpec>& tables, const std::vector<RunResult>& results) {
  Cells cells{{"scene", "run"}};
  std::vector<const Column*> columns;
  for (const Column& column : kDetails)
    if (std::any_of(results.begin(), results.end(),
                    [&](const RunResult& r) { return r.figure(column.figure); })) {
      columns.push_back(&column);
      cells[0].push_back(column.head);
    }
  std::set<std::pair<std::string, std::string>> done;
  for (const TableSpec& table : tables)
    for (const std::string& scene : table.scenes)
      for (const std::string& run : runsOf(table)) {
        if (!done.insert({scene, run}).second) continue;
        cells.push_back({scene, run});
        for (const Column* column : columns) {
          const auto spread = spreadOf(results, scene, run, column->figure);
          cells.back().push_back(spread ? number(spread->median, column->digits) : "–");
        }
      }
  return cells;
}

std::vector<std::string> failures(const std::vector<RunResult>& results) {
  std::vector<std::string> lines;
  for (const RunResult& result : results)
    if (!result.failed.empty())
      lines.push_back(result.key.scene + ", seed " + std::to_string(result.key.seed) + ", " + result.key.run +
                      ": " + result.failed);
  return lines;
}

std::string alignedText(const Cells& cells) {
  std::vector<size_t> widths;
  for (const auto& row : cells) {
    widths.resize(std::max(widths.size(), row.size()));
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width(row[i]));
  }
  std::string text;
  for (const auto& row : cells) {
    for (size_t i = 0; i < row.size(); ++i) {
      text += row[i];
      if (i + 1 < row.size()) text += std::string(widths[i] - width(row[i]) + 2, ' ');
    }
    text += "\n";
  }
  return text;
}

std::string markdown(const Cells& cells) {
  std::string text;
  for (size_t r = 0; r < cells.size(); ++r) {
    for (const std::string& cell : cells[r]) text += "| " + cell + " ";
    text += "|\n";
    if (r > 0) continue;
    for (size_t i = 0; i < cells[0].size(); ++i) text += "|---";
    text += "|\n";
  }
  return text;
}

}  // namespace sgraphs::bench
