#pragma once

#include <string>
#include <vector>

#include "tools/bench/accuracy/run_result.h"
#include "tools/bench/accuracy/run_spec.h"

namespace sgraphs::bench {

// Cells of a table, the first row its head.
using Cells = std::vector<std::vector<std::string>>;

// "0.0123 (0.0120–0.0127)": median, and the least and greatest if there are several seeds. A map whose median
// completeness is below what makes it count is marked with *.
Cells resultCells(const TableSpec& table, const std::vector<RunResult>& results);

// The paper's own figures for this table; empty if it has none.
Cells printedCells(const TableSpec& table);
std::string printedCaption(const TableSpec& table);

// What else was measured of each scene and run of the tables, medians over the seeds: the head names it.
Cells detailCells(const std::vector<TableSpec>& tables, const std::vector<RunResult>& results);

// One line for each run that failed.
std::vector<std::string> failures(const std::vector<RunResult>& results);

// For a terminal (columns of equal width) and for Markdown.
std::string alignedText(const Cells& cells);
std::string markdown(const Cells& cells);

}  // namespace sgraphs::bench
