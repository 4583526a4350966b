#include "tools/bench/accuracy/printed_values.h"

namespace sgraphs::bench {
namespace {

constexpr double kNone = -1;

constexpr const char* kAteScenes[] = {"CF-1", "CF-2", "SE-1", "SE-2"};
constexpr PrintedRow kAte[] = {
    {"HDL-SLAM", {0.09, 0.11, 0.04, 0.15}},
    {"A-LOAM", {0.07, 0.10, 0.16, 0.32}},
    {"M-LOAM", {0.15, 0.39, 0.65, 2.82}},
    {"F-LOAM", {3.90, 0.44, 0.15, 0.24}},
    {"SC-A-LOAM", {0.45, 0.43, 0.43, 0.64}},
    {"LeGO-LOAM", {kNone, kNone, kNone, kNone}},
    {"S-Graph w/o top layer", {0.05, 0.17, 0.40, 1.01}},
    {"S-Graph", {0.04, 0.07, 0.03, 0.05}},
    {"S-Graph+", {0.03, 0.04, 0.02, 0.13}},
};

constexpr const char* kMapScenes[] = {"CF-1", "CF-2", "LC-1"};
constexpr PrintedRow kMap[] = {
    {"HDL-SLAM", {1.34, 0.37, 1.45}},
    {"A-LOAM", {8.03, 1.20, 3.14}},
    {"M-LOAM", {3.73, 1.93, 1.68}},
    {"F-LOAM", {7.63, 1.15, 2.90}},
    {"SC-A-LOAM", {4.86, 0.75, 2.89}},
    {"LeGO-LOAM", {4.08, 0.70, 3.40}},
    {"S-Graph w/o top layer", {1.21, 0.36, 1.45}},
    {"S-Graph", {0.33, 0.37, 1.32}},
    {"S-Graph+", {0.31, 0.33, 1.31}},
};

}  // namespace

std::optional<PrintedTable> printedTable(std::string_view table_id) {
  if (table_id == "ate")
    return PrintedTable{"ATE [m], simulated, LiDAR only: theirs, on their data", kAteScenes, kAte};
  if (table_id == "map")
    return PrintedTable{
        "Point-cloud RMSE [m] against the architect's plan, real sites, robot's encoders: theirs, on their "
        "data",
        kMapScenes, kMap};
  return std::nullopt;
}

}  // namespace sgraphs::bench
