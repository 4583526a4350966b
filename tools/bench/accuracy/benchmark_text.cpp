#include "tools/bench/accuracy/benchmark_text.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>
#include <thread>

#include "tools/bench/accuracy/result_tables.h"

namespace sgraphs::bench {
namespace {

constexpr char kBegin[] = "<!-- sgraphs bench accuracy: begin; what stands here is overwritten -->";
constexpr char kEnd[] = "<!-- sgraphs bench accuracy: end -->";
constexpr char kTitle[] = "# Benchmark\n";

constexpr char kHowToRead[] =
    "Each cell: median over the seeds, and in brackets the least and the greatest; [n] where only n of the "
    "seeds were run. All rows of a scene and "
    "seed "
    "stand on the same recording;\nthe figures are those of `sgraphs eval` "
    "([docs/accuracy.md](docs/accuracy.md)). "
    "Beside a map's RMSE stands its completeness; * marks a\nmap that is less than 0.90 complete and does "
    "not "
    "count.\n";

constexpr char kAboutBaselines[] =
    "**Baselines** are made of PCL 1.13 here, single-threaded, from the same logs through the same decoder, "
    "in the manner of HDL-SLAM, which\nitself was not run: returns within 0.5 to 100 m, voxels of 0.1 m, "
    "points "
    "with fewer than 2 neighbours within 0.5 m dropped; each scan\nregistered to the last keyframe's (a new "
    "one "
    "after 0.5 m or 0.5 rad) from a guess by constant velocity. GICP's reach (0.5 m) and the change\nthat "
    "ends "
    "NDT (0.001) are the best of eleven settings tried, one change at a time, on small_office with seed 1; a "
    "thorough search may find\nbetter ones. HDL-SLAM turns points back only with an IMU, which is not "
    "recorded: no "
    "deskewing. The pose graph has a keyframe every 1 m or\n1 rad and GICP loops within 2 m, weighted by "
    "fitness, "
    "without a floor. With encoder odometry the legs give GICP and NDT their guess,\nand are the odometry of "
    "the "
    "pose graph. Maps hold every scan at its pose, which is more than HDL-SLAM keeps.\n";

std::string valueAfter(const std::string& path, const std::string& key, char separator) {
  std::ifstream in(path);
  std::string line;
  while (std::getline(in, line)) {
    if (line.rfind(key, 0) != 0) continue;
    std::string value = line.substr(line.find(separator) + 1);
    value.erase(0, value.find_first_not_of(" \t\""));
    value.erase(value.find_last_not_of(" \t\"") + 1);
    return value;
  }
  return "unknown";
}

std::string programs(const std::vector<RunResult>& results) {
  std::set<std::string> digests;
  for (const RunResult& result : results) digests.insert(result.key.program.substr(0, 12));
  std::string text;
  for (const std::string& digest : digests) text += (text.empty() ? "" : ", ") + digest;
  return text;
}

// Times measured on a busy machine are longer; accuracy is the same.
std::string loadText() {
  double load[1] = {0};
  char text[64] = "";
  if (getloadavg(load, 1) == 1) std::snprintf(text, sizeof text, "load %.1f at the end", load[0]);
  return text;
}

std::string settings(const std::vector<RunResult>& results) {
  return results.empty() || results[0].key.settings.empty() ? "the defaults"
                                                            : "`" + results[0].key.settings + "`";
}

std::string seedsText(const std::vector<RunResult>& results) {
  std::set<uint64_t> seeds;
  for (const RunResult& result : results) seeds.insert(result.key.seed);
  std::string text;
  for (const uint64_t seed : seeds) text += (text.empty() ? "" : ", ") + std::to_string(seed);
  return text;
}

bool hasBaselines(const std::vector<TableSpec>& tables) {
  for (const TableSpec& table : tables)
    for (const RowSpec& row : table.rows)
      if (row.title.find("PCL") != std::string::npos) return true;
  return false;
}

}  // namespace

std::string machineText() {
  const std::string memory = valueAfter("/proc/meminfo", "MemTotal", ':');
  char gib[32];
  std::snprintf(gib, sizeof gib, "%.0f GiB", std::atof(memory.c_str()) / (1024 * 1024));
  return valueAfter("/proc/cpuinfo", "model name", ':') + ", " +
         std::to_string(std::max(1U, std::thread::hardware_concurrency())) + " cores, " + gib + ", " +
         valueAfter("/etc/os-release", "PRETTY_NAME", '=') + ", " + loadText();
}

std::string accuracySection(const std::vector<TableSpec>& tables, const std::vector<RunResult>& results,
                            const BenchmarkOrigin& origin) {
  std::string text = std::string(kBegin) + "\n## Accuracy\n    " + origin.command + "\n\n";
  text += "sgraphs " + origin.version + (origin.commit.empty() ? "" : ", commit " + origin.commit) +
          " (program " + programs(results) + "), " + origin.date + "; " + origin.machine + "; seeds " +
          seedsText(results) + "; settings: " + settings(results) + ".\n\n" + kHowToRead;
  if (hasBaselines(tables)) text += std::string("\n") + kAboutBaselines;
  for (const TableSpec& table : tables) {
    text += "\n### " + table.title + "\n" + markdown(resultCells(table, results));
    if (const Cells printed = printedCells(table); !printed.empty())
      text += "\n" + printedCaption(table) +
              " (S-Graphs+ paper, arXiv 2211.08754). Their buildings are "
              "not those of the table above, whatever the names:\n\n" +
              markdown(printed);
  }
  text += "\n### All else that was measured\nMedians over the seeds.\n\n" +
          markdown(detailCells(tables, results));
  if (const auto failed = failures(results); !failed.empty()) {
    text += "\nRuns that failed:\n\n";
    for (const std::string& line : failed) text += "- " + line + "\n";
  }
  return text + kEnd + "\n";
}

std::string withSection(const std::string& old_text, const std::string& section) {
  const size_t begin = old_text.find(kBegin);
  const size_t end = old_text.find(kEnd);
  if (begin != std::string::npos && end != std::string::npos && begin < end) {
    size_t after = end + std::string(kEnd).size();
    if (after < old_text.size() && old_text[after] == '\n') ++after;
    return old_text.substr(0, begin) + section + old_text.substr(after);
  }
  const std::string head = old_text.empty() ? kTitle : old_text;
  return head + (head.back() == '\n' ? "" : "\n") + "\n" + section;
}

}  // namespace sgraphs::bench
