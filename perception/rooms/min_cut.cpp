#include "perception/rooms/min_cut.h"

#include <algorithm>
#include <limits>

namespace sgraphs {
namespace {

constexpr double kNothing = 1e-9;  // capacities are areas: this is a speck of dust

}  // namespace

MinCut::MinCut(size_t num_nodes) : source_(num_nodes), sink_(num_nodes + 1), from_(num_nodes + 2) {}

void MinCut::addArc(size_t from, size_t to, double capacity) {
  from_[from].push_back(arcs_.size());
  arcs_.push_back({to, capacity});
  from_[to].push_back(arcs_.size());
  arcs_.push_back({from, 0.0});
}

// Whoever is reached from the source in the end is inside: an arc to the sink is cut for an inside node.
void MinCut::addNode(size_t node, double cost_inside, double cost_outside) {
  addArc(source_, node, cost_outside);
  addArc(node, sink_, cost_inside);
}

void MinCut::addPair(size_t a, size_t b, double cost) {
  addArc(a, b, cost);
}

bool MinCut::findLevels() {
  level_.assign(from_.size(), -1);
  level_[source_] = 0;
  std::vector<size_t> queue{source_};
  for (size_t i = 0; i < queue.size(); ++i)
    for (const size_t index : from_[queue[i]]) {
      const Arc& arc = arcs_[index];
      if (arc.capacity <= kNothing || level_[arc.to] >= 0) continue;
      level_[arc.to] = level_[queue[i]] + 1;
      queue.push_back(arc.to);
    }
  return level_[sink_] >= 0;
}

double MinCut::push(size_t node, double flow) {
  if (node == sink_) return flow;
  for (size_t& i = next_[node]; i < from_[node].size(); ++i) {
    const size_t index = from_[node][i];
    if (arcs_[index].capacity <= kNothing || level_[arcs_[index].to] != level_[node] + 1) continue;
    const double pushed = push(arcs_[index].to, std::min(flow, arcs_[index].capacity));
    if (pushed <= kNothing) continue;
    arcs_[index].capacity -= pushed;
    arcs_[index ^ 1].capacity += pushed;
    return pushed;
  }
  return 0;
}

std::vector<bool> MinCut::inside() {
  while (findLevels()) {
    next_.assign(from_.size(), 0);
    while (push(source_, std::numeric_limits<double>::infinity()) > kNothing) {
    }
  }
  std::vector<bool> result(from_.size() - 2);
  for (size_t i = 0; i < result.size(); ++i) result[i] = level_[i] >= 0;
  return result;
}

}  // namespace sgraphs
