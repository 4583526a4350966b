#pragma once

#include <optional>
#include <vector>

#include "perception/free_space/clusters/cell_labels.h"

namespace sgraphs {

// Where two regions touch: one connected line of cells on both sides of their border.
struct Contact {
  int32_t a = kNoLabel, b = kNoLabel;  // a < b
  std::vector<uint32_t> cells;         // ascending
  uint32_t saddle = 0;                 // its widest cell: where a path from one to the other would go
};

// All contacts by (a, b, first cell).
std::vector<Contact> contactsOf(const StoreyGrid& grid, const CellLabels& labels);

// The narrowest line from obstacle to obstacle (or to what nobody has seen) across a saddle; left and right
// as seen when walking from a to b.
std::optional<Cut> narrowestAt(const StoreyGrid& grid, const CellLabels& labels, const Contact& contact);

}  // namespace sgraphs
