#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "backend/backend.h"
#include "backend/graph/situational_graph.h"
#include "backend/solver/incremental_solver.h"

namespace sgraphs {

// The graph and its solver as one thing: every node has a state, every factor of the graph one of the
// solver. What is added here is added to both; after a solve the nodes hold the states' values.
class GraphBuilder {
 public:
  explicit GraphBuilder(const SolverOptions& options) : solver_(options) {}

  const SituationalGraph& graph() const { return graph_; }
  const IncrementalSolver& solver() const { return solver_; }

  // The first keyframe is held: it defines the map. The node's pose is the initial value.
  void addKeyframe(KeyframeNode node);
  void addFloor(FloorId id) { graph_.floors.try_emplace(id, FloorNode{.id = id}); }
  // The node's normal, anchor and offset are the initial values; the id is given here.
  PlaneId addPlane(PlaneNode node);

  // A relative pose that closes a circle; its effect is not local.
  static bool closesCircle(const RelativePose& z);
  int64_t addRelativePose(const RelativePose& z);
  // A loop by its id: known from now on, at first without a part in the graph; switched on and off;
  // forgotten.
  void addLoop(LoopId id, const RelativePose& z) { graph_.loops[id] = {z, -1}; }
  void switchLoop(LoopId id, bool on);
  void removeLoop(LoopId id);
  void addUp(KeyframeId keyframe, const Eigen::Vector3d& up_body, double sigma_rad);
  void addObservation(KeyframeId keyframe, PlaneId plane, const PlaneObservation& z);
  // Takes observations back, by the ids of their factors; what is known of their planes else stays.
  void removeObservations(const std::set<int64_t>& ids);
  // A plumb wall alone does not say where up is: it needs an up that is measured, or a level plane before it.
  bool hasUp() const { return up_state_ >= 0; }
  void addPlaneUp(PlaneId plane, bool level, double sigma_rad);
  void addFaces(PlaneId a, PlaneId b, double sigma_rad);
  void addSameHeight(PlaneId a, PlaneId b, double sigma_m);

  // Nodes of the upper layers. Rooms and storeys have states once something binds them.
  void putRoom(const RoomObservation& seen);  // new, or seen again
  void removeRoom(RoomId id);                 // with its factors
  void setFloor(KeyframeId keyframe, FloorId floor) { graph_.keyframes.at(keyframe).floor = floor; }
  void setFloor(PlaneId plane, FloorId floor) { graph_.planes.at(plane).floor = floor; }
  void removeFloor(FloorId id);  // with its factors; nothing may be on it
  void setDoorways(std::map<PassageId, Doorway> doorways) { graph_.doorways = std::move(doorways); }
  void setFreeSpace(std::shared_ptr<const FreeSpace> free_space) {
    graph_.free_space = std::move(free_space);
  }
  // Something holds the centre.
  bool hasFactor(const CenterOf& of) const;
  // Where no factor holds it, it is where it was seen; nothing otherwise.
  void setCenter(const CenterOf& of, const Eigen::Vector2d& center_map);
  void setHeight(FloorId floor, bool has_height, double z_m);

  // Factors of the upper layers: the id is given here.
  void addCenterWalls(CenterWallsFactor factor);
  void addCenterAnchor(CenterAnchorFactor factor);
  void addRoomShape(RoomShapeFactor factor);
  void addFloorHeight(FloorHeightFactor factor);
  void addFloorRoom(FloorRoomFactor factor);
  void removeFactor(int64_t id);  // one of these

  // All that is known of `from` becomes knowledge of `into`, which lives on; `from` is no node any more.
  void mergePlanes(PlaneId from, PlaneId into);
  // Before the two are merged though they are apart, on the word of others (a room): until the next solve of
  // the whole graph has brought them together, what was seen of them is not taken for outliers.
  void trust(PlaneId plane);

  // Turns the map about the first keyframe so that `up` is z again and the first keyframe keeps its heading.
  // Residuals do not change: the whole map turns. Nothing without an up factor.
  void relevel();

  // Keyframes are put elsewhere, and each plane goes with the keyframe that saw it first. The first keyframe
  // stays. A start for solveFromAfar().
  void moveKeyframes(const std::map<KeyframeId, SE3>& T_map_body);

  IncrementalSolver::Report solve(bool whole);
  // The whole graph where its states may be decimetres off: what was seen of planes is not taken for an
  // outlier at first, and then by ever stricter measure.
  IncrementalSolver::Report solveFromAfar();

  void setExtent(PlaneId plane, const std::vector<Eigen::Vector2d>& points);
  void setCovariance(KeyframeId keyframe, const Matrix6d& covariance) {
    graph_.keyframes.at(keyframe).covariance = covariance;
  }
  void setCovariance(PlaneId plane, const Eigen::Matrix3d& at_centroid);
  void setLabel(PlaneId plane, PlaneLabel label) { graph_.planes.at(plane).label = label; }

  // Marginals at the present states, if the factors determine them.
  std::optional<Matrix6d> covariance(KeyframeId id) const;
  // Of all, in the time of about one factorisation; planes at their centroids. Empty if undetermined.
  std::map<KeyframeId, Matrix6d> keyframeCovariances() const;
  std::map<PlaneId, Eigen::Matrix3d> planeCovariances() const;

  std::map<std::string, FactorStatistics> statistics() const;

 private:
  // Robust factors are quadratic up to the 99 % quantile of chi-square (11.3, 9.2, 6.6 with 3, 2, 1 degrees
  // of freedom); a wrong one pulls less the further it is off (Cauchy).
  static constexpr double kCauchy3 = 3.4, kCauchy2 = 3.0, kCauchy1 = 2.6;
  using StateId = IncrementalSolver::StateId;
  struct Registered {
    std::string kind;
    IncrementalSolver::FactorId factor = -1;
  };
  int64_t add(const std::string& kind, std::unique_ptr<ceres::CostFunction> cost,
              const std::vector<StateId>& states, std::optional<double> cauchy_scale);
  StateId upState();
  StateId centerState(const CenterOf& of);
  void drop(int64_t factor);
  void mergeInRooms(PlaneId from, PlaneId into, StateId old_state, StateId state);
  void takeOverCenter(StateId state);
  void takeOver(const std::vector<StateId>& states);

  SituationalGraph graph_;
  IncrementalSolver solver_;
  std::map<KeyframeId, StateId> keyframe_states_;
  std::map<PlaneId, StateId> plane_states_;
  std::map<StateId, KeyframeId> keyframe_of_state_;
  std::map<StateId, PlaneId> plane_of_state_;
  std::map<RoomId, StateId> room_states_;
  std::map<FloorId, StateId> floor_states_, height_states_;
  std::map<StateId, CenterOf> center_of_state_;
  std::map<StateId, FloorId> height_of_state_;
  StateId up_state_ = -1;
  std::map<int64_t, Registered> factors_;  // by id of the graph's factors
  std::vector<int64_t> trusted_;           // observations that are not robust for now
  int64_t next_factor_ = 0;
  int64_t next_plane_ = 0;
};

}  // namespace sgraphs
