#pragma once

#include <cstddef>
#include <vector>

namespace sgraphs {

// Splits nodes into inside and outside at the least cost, which is a sum of costs of nodes and of pairs that
// fall apart: a minimum cut (Dinic's algorithm). Of equally cheap splits the one with the fewest inside.
class MinCut {
 public:
  explicit MinCut(size_t num_nodes);

  // What it costs to have a node inside, or outside; not negative.
  void addNode(size_t node, double cost_inside, double cost_outside);
  // What it costs to have a inside and b outside; not negative.
  void addPair(size_t a, size_t b, double cost);
  std::vector<bool> inside();

 private:
  struct Arc {
    size_t to;
    double capacity;  // what is left of it
  };
  void addArc(size_t from, size_t to, double capacity);
  bool findLevels();
  double push(size_t node, double flow);

  size_t source_, sink_;
  std::vector<Arc> arcs_;                  // the reverse of arc i is i ^ 1
  std::vector<std::vector<size_t>> from_;  // arcs by the node they leave
  std::vector<int> level_;
  std::vector<size_t> next_;  // first arc of a node that may still carry something
};

}  // namespace sgraphs
