#pragma once

#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "backend/graph_builder.h"
#include "backend/planes/building_axes.h"
#include "backend/planes/plane_association.h"
#include "backend/planes/plane_layer_config.h"

namespace sgraphs {

// Walls, floors and ceilings of the graph: which observation is of which plane, when a plane is mapped, what
// else is known of it, and which planes turn out to be one.
class PlaneLayer {
 public:
  PlaneLayer(const PlaneLayerConfig& config, GraphBuilder& builder) : config_(config), builder_(builder) {}

  // The robot has moved on: what it knows of the planes' places relative to itself has grown older.
  // z: the measurement of the new keyframe's pose from the one before.
  void advance(const RelativePose& z);
  // The robot is not where it was last but elsewhere in the map: what is measured next is measured from a
  // keyframe there. `there`: how well the others are known from that one (tangent of its body).
  void carriedTo(const std::map<KeyframeId, Matrix6d>& there);

  // Associates what the newest keyframe (in the graph, at its predicted pose) sees.
  struct Sighting {
    std::vector<PlaneObservation> observations;
    std::vector<std::optional<size_t>> candidate;  // by observation
    Matrix6d information;              // of mapped planes about the keyframe's pose, tangent of body
    std::vector<std::string> refused;  // one line for each plane that cannot be weighed
  };
  Sighting associate(KeyframeId keyframe, const KeyframePlanes& planes) const;

  // Adds factors, and planes that have been seen often enough. True if a plane came back that was last seen
  // long ago: its effect is not local.
  bool add(KeyframeId keyframe, const Sighting& sighting);

  // After the round's solve: planes that are one are merged, faces and heights paired, extents and labels
  // brought up to date. Where the whole graph was solved all extents are made anew.
  void settle(bool whole, bool idle);

  // Proof from elsewhere (a room) that the two are one: `into` lives on.
  void merge(PlaneId from, PlaneId into);

  // The map was bent by a loop that is none, and lies again as odometry has it, roughly: what was taken for
  // one plane on the word of that loop comes apart.
  void mapUnbent();

  // Loops have moved the map. Observations that do not fit their plane any more go to the one they do fit, or
  // are dropped; extents are made anew; and for some rounds all planes are looked at for twins.
  // `newest`: covariance of the newest keyframe's pose relative to each other keyframe (tangent of body).
  void mapMended(const std::map<KeyframeId, Matrix6d>& newest);

  // Covariances as the whole graph has them now.
  void refreshCovariances();

  // Planes whose announced content is out of date, and merged ones.
  std::vector<PlaneId> takeChanged();

  double shared_information() const { return config_.shared_information; }

 private:
  // What is known of a plane relative to the newest keyframe.
  struct Track {
    Eigen::Matrix3d covariance;         // of the plane's tangent at the anchor, relative to the keyframe
    Eigen::Vector3d normal_map;         // whose axes the covariance is in
    Matrix6d drift = Matrix6d::Zero();  // of the newest keyframe's pose relative to the one that saw it last
    KeyframeId last_seen;
  };
  // Seen once: no node of the graph yet.
  struct Unmapped {
    KeyframeId keyframe;
    PlaneObservation z;
    PlaneNode plane;
    Track track;
  };
  struct Announced {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double d = 0;
    int64_t num_observations = 0;
    FloorId floor;
  };

  // Mapped planes by id, then those seen once; of two, which storey they are on must not speak against it.
  struct Known {
    std::vector<PlaneCandidate> planes;
    std::vector<size_t> index;  // among all mapped planes, then those seen once
  };
  Known candidates(FloorId floor) const;
  void map(const Unmapped& unmapped);
  void observe(KeyframeId keyframe, PlaneId plane, const PlaneObservation& z, Track& track);
  void addUprights();
  void forgetOld(KeyframeId newest);
  bool areTwins(PlaneId a, PlaneId b) const;
  void countTwins(bool idle);
  void mergeTwins();
  template <typename Factor>
  static bool paired(const std::vector<Factor>& factors, PlaneId a, PlaneId b);
  void pairFaces(PlaneId plane);
  void pairHeights(PlaneId plane);
  void remakeExtents();
  // What is off its own plane by more than `own` goes to the one it is nearest to within `other`.
  void reassociate(const AssociationGate& own, const AssociationGate& other);
  bool fits(const ObservationFactor& factor, const PlaneNode& plane, const AssociationGate& gate) const;
  PlaneId planeFor(const ObservationFactor& factor, const AssociationGate& gate) const;
  void mapApart(const std::vector<ObservationFactor>& astray, const AssociationGate& gate);

  PlaneLayerConfig config_;
  GraphBuilder& builder_;
  BuildingAxes axes_;
  std::map<PlaneId, Track> tracks_;
  std::vector<Unmapped> unmapped_;
  std::map<std::pair<PlaneId, PlaneId>, int> twins_;  // keyframes that took the two for one
  std::vector<PlaneId> seen_;                         // in this round
  int rounds_to_look_at_all_ = 0;                     // for twins, since the map was mended
  std::set<PlaneId> upright_unknown_;                 // mapped planes that await an `up` to be compared with
  std::map<PlaneId, Announced> announced_;
  std::set<PlaneId> merged_away_;
};

}  // namespace sgraphs
