#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backend/backend_config.h"
#include "backend/graph/situational_graph.h"
#include "common/types/keyframe.h"
#include "common/types/loops.h"

namespace sgraphs {

// What joined a round.
struct RoundInput {
  int64_t round = 0;
  Time time;
  std::optional<Keyframe> keyframe;  // none: an idle round
  std::optional<KeyframePlanes> planes =
      {};  // of that keyframe; none: the layer is off, or the message was lost
  // Made of an earlier round's map; none: the layer is off, the first round, or the message was lost.
  std::shared_ptr<const FreeSpace> free_space = {};
  std::optional<Rooms> rooms = {};
  std::optional<LoopClosures> loops = {};
};

struct RoundOutput {
  std::vector<KeyframeId> changed;  // keyframes that moved by more than the configured step, and the new one
  std::vector<PlaneId> changed_planes;  // likewise, with those that were merged away
  bool changed_rooms = false;           // rooms, doorways or floors came, went or moved
  SE3 T_map_odom;
  Matrix6d keyframe_covariance = Matrix6d::Identity();  // newest keyframe in map, conservative
  std::string graph_digest;
  bool bridged = false;              // the keyframe came without a usable measurement against the graph
  bool whole_graph = false;          // every state was free in this round, not only the neighbourhood
  std::vector<std::string> refused;  // one line for each thing of the input that was refused: what and why
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

  // A round with a keyframe costs what it changed. An idle round brings the graph to the optimum of the whole
  // (within its iterations; the next one goes on), so a run ends with idle rounds until nothing changes.
  RoundOutput step(RoundInput input);
  const SituationalGraph& graph() const;
  // By kind: odometry, neighbour, loop, up, observes, plane_up, faces, same_height, room_wall (finite),
  // room_wall_infinite (and polygons), room_shape, floor_wall, floor_height, floor_room. dof counts
  // residuals; those of the whole graph are their sum less 6 per keyframe but the first, 3 per plane, 2 per
  // bound centre, 1 per bound height and, where there is an up factor, 2. chi2 is at the present states,
  // without robust loss.
  std::map<std::string, FactorStatistics> factorStatistics() const;
  // Marginal covariances of T_map_body (tangent of body) given the first keyframe, whose own is zero. Costs a
  // factorisation of the whole graph.
  std::map<KeyframeId, Matrix6d> keyframeCovariances() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgraphs
