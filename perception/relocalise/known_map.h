#pragma once

#include <map>
#include <vector>

#include "perception/loops/loop_verification.h"
#include "perception/loops/wall_layout.h"
#include "perception/relocalise/relocaliser.h"

namespace sgraphs {

// A place of the known map that the robot may be at.
struct KnownPlace {
  Place place;
  SE3 T_map_body;
};

// One storey of a known map: places as loops remember them, and the walls around them from above.
class KnownStorey {
 public:
  // Of the views of one storey; one place per `spacing_m`.
  KnownStorey(const std::vector<const MapView*>& views, double spacing_m);

  // Where the walls fit, best first, with heights of the body; all headings.
  std::vector<LayoutMatch> search(const std::vector<WallPoint>& query, int max_matches) const;
  // The place nearest to a position from above; nullptr if none is within `within_m`.
  const KnownPlace* nearest(const Eigen::Vector2d& position_map, double within_m) const;
  // Places about one of them, in its body.
  OldSurroundings surroundingsOf(const KnownPlace& anchor, double radius_m) const;

 private:
  std::vector<KnownPlace> places_;  // by id
  std::vector<Eigen::Vector2d> positions_map_;
  WallLayout layout_;
};

}  // namespace sgraphs
