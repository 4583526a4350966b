#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "backend/graph/situational_graph.h"

namespace sgraphs {

// Notices what has become of rooms, doorways and storeys since they were last announced.
class RoomChanges {
 public:
  // True if one of them came, went, changed what it is bound to, or moved by more than a millimetre.
  bool take(const SituationalGraph& graph);

 private:
  struct Announced {
    std::vector<int64_t> ids;
    std::vector<double> places_m;
  };
  using Key = std::pair<char, int64_t>;  // layer and id

  std::map<Key, Announced> announced_;
};

}  // namespace sgraphs
