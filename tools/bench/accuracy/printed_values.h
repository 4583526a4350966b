#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace sgraphs::bench {

// Most scenes of one of the paper's tables.
inline constexpr int kMaxPrintedScenes = 4;

// A row of the S-Graphs+ paper (arXiv 2211.08754): its authors' figures, on their data.
struct PrintedRow {
  const char* system;
  double values[kMaxPrintedScenes];  // [m]; negative where the paper prints "-"
};

struct PrintedTable {
  const char* caption;
  std::span<const char* const> scenes;
  std::span<const PrintedRow> rows;
};

// For the id of a TableSpec; none where the paper has no such table.
std::optional<PrintedTable> printedTable(std::string_view table_id);

}  // namespace sgraphs::bench
