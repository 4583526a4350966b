#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace sgraphs {

// A piece of wall from above: where it stands and which way it faces.
struct WallPoint {
  Eigen::Vector2f position = Eigen::Vector2f::Zero();  // [m]
  float heading_rad = 0;                               // of the normal
};

// A place for the query in the layout: p_map = R(yaw) p_query + position.
struct LayoutMatch {
  Eigen::Vector2d position_map = Eigen::Vector2d::Zero();
  double yaw_rad = 0;
  double score = 0;  // share of the query's walls that stand on walls facing the same way
};

struct LayoutSearch {
  Eigen::Vector2d centre_map = Eigen::Vector2d::Zero();
  double yaw_rad = 0;
  double radius_m = 1;
  double yaw_range_rad = 0.1;  // to either side; pi: all headings
  int max_matches = 6;
  // Where the query may stand, in place of the disc about the centre; empty: anywhere in it.
  std::vector<Eigen::Vector2d> positions_map = {};
};

// The walls about an old place from above, in which a newer look at walls is sought: the appearance that
// finds and aligns returns where the pose alone is off by metres. Rooms that look alike give several matches,
// which is what tells that a return is ambiguous.
class WallLayout {
 public:
  // Walls farther than half_size_m from the centre in x or y are left out.
  WallLayout(const Eigen::Vector2d& centre_map, double half_size_m);
  void add(const WallPoint& wall_map);

  // Distinct matches (0.75 m or 10 degrees apart), best first; those far below the best are left out.
  std::vector<LayoutMatch> search(const std::vector<WallPoint>& query, const LayoutSearch& where) const;

 private:
  struct Mask {
    uint16_t exact = 0;  // one bit per heading of 22.5 degrees
    uint16_t near = 0;   // of this cell and its neighbours
  };
  const Mask* at(float x_m, float y_m) const;

  Eigen::Vector2f origin_;
  int size_;
  std::vector<Mask> cells_;
};

}  // namespace sgraphs
