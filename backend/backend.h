#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backend/backend_config.h"
#include "backend/graph/situational_graph.h"
#include "common/types/keyframe.h"

namespace sgraphs {

// What joined a round. Planes, rooms and loops become further members.
struct RoundInput {
  int64_t round = 0;
  Time time;
  std::optional<Keyframe> keyframe;  // none: an idle round
};

struct RoundOutput {
  std::vector<KeyframeId> changed;  // keyframes that moved by more than the configured step, and the new one
  SE3 T_map_odom;
  Matrix6d keyframe_covariance = Matrix6d::Identity();  // newest keyframe in map, conservative
  std::string graph_digest;
};

// How well one kind of factor fits.
struct FactorStatistics {
  int64_t count = 0;
  int64_t dof = 0;
  double chi2 = 0;
};

// Observations become one optimised graph. A pure function of its inputs so far, single-threaded.
class Backend {
 public:
  explicit Backend(const BackendConfig& config);
  ~Backend();

  RoundOutput step(RoundInput input);
  const SituationalGraph& graph() const;
  // By kind: odometry, neighbour, loop, up.
  std::map<std::string, FactorStatistics> factorStatistics() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgraphs
