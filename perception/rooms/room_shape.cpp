#include "perception/rooms/room_shape.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include "perception/rooms/room_outline.h"

namespace sgraphs {
namespace {

constexpr double kMinCovered = 0.75;   // share of a room whose floor or furniture was seen
constexpr double kMinIncluded = 0.75;  // share of a cluster that its room must hold
constexpr double kMinEdgeShare = 0.3;  // of an edge that a wall stands along, else it is bare
// Rooms of which so much of the outline is walled may have more frontier, by this factor.
constexpr double kClosedShare = 0.8, kClosed = 2.0;
// A ring of walls has no more bare outline than this; quadrilaterals are judged by their pairs.
constexpr double kMaxBareRing = 0.25;

struct Side {
  Eigen::Vector2d a, b;
  const Wall* wall = nullptr;  // null: bare
  double walled_m = 0;

  double length() const { return (b - a).norm(); }
};

// The wall that stands along most of an edge.
const Wall* wallAlong(const OutlineLine& line, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Wall* best = nullptr;
  double most = 0;
  for (const Wall& wall : line.walls) {
    if (wall.along.dot(b - a) <= 0) continue;
    const double overlap =
        std::min(wall.along.dot(b), wall.end_m) - std::max(wall.along.dot(a), wall.begin_m);
    if (overlap <= most) continue;
    most = overlap;
    best = &wall;
  }
  return best;
}

std::vector<Side> sidesOf(const RoomOutline& outline, const std::vector<OutlineLine>& lines) {
  std::vector<Side> sides;
  for (size_t i = 0; i < outline.corners.size(); ++i) {
    const OutlineCorner& corner = outline.corners[i];
    Side side{corner.position_map, outline.corners[(i + 1) % outline.corners.size()].position_map};
    if (corner.line >= 0) {
      const OutlineLine& line = lines[static_cast<size_t>(corner.line)];
      side.walled_m = walledLength(line, side.a, side.b).all_m;
      if (side.walled_m > kMinEdgeShare * side.length()) side.wall = wallAlong(line, side.a, side.b);
    }
    sides.push_back(side);
  }
  return sides;
}

// Length over which two sides stand opposite each other; 0 if they do not.
double opposedLength(const Side& s, const Side& t, const RoomsConfig& config) {
  if (!s.wall || !t.wall || s.wall->normal.dot(t.wall->normal) > -std::cos(config.opposed_rad)) return 0;
  const Eigen::Vector2d middle = 0.5 * (t.a + t.b);
  if (s.wall->distance(middle) < config.min_width_m) return 0;
  const Eigen::Vector2d& u = s.wall->along;
  return std::max(0.0, std::min(u.dot(s.b), u.dot(t.a)) - std::max(u.dot(s.a), u.dot(t.b)));
}

struct Pair {
  const Wall *a = nullptr, *b = nullptr;
  double length_m = 0;
};

Pair longestPair(const std::vector<Side>& sides, const RoomsConfig& config) {
  Pair best;
  for (size_t i = 0; i < sides.size(); ++i)
    for (size_t k = i + 1; k < sides.size(); ++k) {
      const double length = opposedLength(sides[i], sides[k], config);
      if (length > best.length_m) best = {sides[i].wall, sides[k].wall, length};
    }
  return best;
}

std::pair<PlaneId, PlaneId> idsOf(const Wall& a, const Wall& b) {
  return std::minmax(a.id, b.id);
}

double bareShare(const std::vector<Side>& sides) {
  double all = 0, bare = 0;
  for (const Side& side : sides) {
    all += side.length();
    bare += side.wall ? 0 : side.length();
  }
  return bare / all;
}

// Names the kind of room and what makes its centre; false if walls make none.
bool classify(const std::vector<Side>& sides, const RoomsConfig& config, RoomShape& shape) {
  const bool quadrilateral = sides.size() == 4;
  if (quadrilateral && opposedLength(sides[0], sides[2], config) > 0 &&
      opposedLength(sides[1], sides[3], config) > 0) {
    shape.kind = RoomKind::kFinite;
    const Wall *a = sides[0].wall, *b = sides[1].wall, *c = sides[2].wall, *d = sides[3].wall;
    shape.pairs = {idsOf(*a, *c), idsOf(*b, *d)};
    std::sort(shape.pairs.begin(), shape.pairs.end());
    shape.center_map = intersection(MidPlane(*a, *c), MidPlane(*b, *d));
    return true;
  }
  const auto num_walls = std::count_if(sides.begin(), sides.end(), [](const Side& s) { return s.wall; });
  const Pair pair = longestPair(sides, config);
  const bool all_walled = num_walls == static_cast<std::ptrdiff_t>(sides.size());
  const bool ring =
      num_walls >= 3 && bareShare(sides) <= kMaxBareRing && (all_walled || !quadrilateral || !pair.a);
  if (ring) {
    shape.kind = RoomKind::kPolygon;
    shape.center_map = polygonCentroid(shape.polygon);
    return true;
  }
  if (!pair.a) return false;
  shape.kind = RoomKind::kInfinite;
  shape.pairs = {idsOf(*pair.a, *pair.b)};
  const MidPlane mid(*pair.a, *pair.b);
  shape.center_map = shape.free_center_map - (mid.normal.dot(shape.free_center_map) + mid.d) * mid.normal;
  return true;
}

// A ring of walls tells a room's shape even if much of its floor was not seen. Where no wall closes it, its
// end is taken from what was seen; only corridors may grow.
double maxFrontierShare(const RoomShape& shape, double walled_share, bool is_corridor,
                        const RoomsConfig& config) {
  if (shape.kind == RoomKind::kInfinite) return (is_corridor ? 1.0 : 0.5) * config.max_frontier_share;
  return (walled_share > kClosedShare ? kClosed : 1.0) * config.max_frontier_share;
}

double walledShare(const std::vector<Side>& sides) {
  double walled = 0, length = 0;
  for (const Side& side : sides) {
    length += side.length();
    walled += side.walled_m;
  }
  return walled / length;
}

bool isSeenEnough(const RoomOutline& outline, const RoomShape& shape, double walled_share,
                  const RoomsConfig& config) {
  return shape.area_m2 >= config.min_area_m2 && walled_share >= config.min_wall_share &&
         outline.covered_m2 >= kMinCovered * shape.area_m2 &&
         outline.covered_m2 >= kMinIncluded * (outline.covered_m2 + outline.left_out_m2);
}

std::optional<RoomShape> shapeAmong(const BorderEvidence& evidence, const FreeSpaceCluster& cluster,
                                    const ClusterBorder& border, const RoomsConfig& config) {
  const RoomOutline outline = outlineOf(border, evidence, config.boundary_cost_m);
  if (outline.corners.size() < 3) return {};
  RoomShape shape;
  const std::vector<Side> sides = sidesOf(outline, evidence.lines);
  for (const Side& side : sides) {
    shape.polygon.push_back(side.a);
    shape.corners.push_back({side.a, side.wall ? side.wall->id : PlaneId{}});
  }
  shape.area_m2 = polygonArea(shape.polygon);
  shape.free_center_map = polygonCentroid(border.polygon);
  const double walled_share = walledShare(sides);
  if (!isSeenEnough(outline, shape, walled_share, config) || !classify(sides, config, shape)) return {};
  if (border.frontierShare() > maxFrontierShare(shape, walled_share, cluster.is_corridor, config)) return {};
  return shape;
}

}  // namespace

std::vector<PlaneId> RoomShape::walls() const {
  std::set<PlaneId> ids;
  for (const RoomCorner& corner : corners)
    if (corner.wall.valid()) ids.insert(corner.wall);
  return {ids.begin(), ids.end()};
}

// (a.normal - b.normal).p + a.d - b.d = 0: where the distances to both are equal. The normals are opposed, so
// their difference does not vanish, wherever the map's origin is.
MidPlane::MidPlane(const Wall& a, const Wall& b) {
  const double norm = (a.normal - b.normal).norm();
  normal = (a.normal - b.normal) / norm;
  d = (a.d - b.d) / norm;
}

Eigen::Vector2d intersection(const MidPlane& a, const MidPlane& b) {
  Eigen::Matrix2d normals;
  normals << a.normal.transpose(), b.normal.transpose();
  return normals.inverse() * Eigen::Vector2d(-a.d, -b.d);
}

std::optional<RoomShape> roomShapeOf(const FreeSpaceCluster& cluster, const std::vector<Wall>& walls,
                                     const RoomsConfig& config) {
  const ClusterBorder border = borderOf(cluster);
  if (border.edges.empty() || border.frontierShare() > kClosed * config.max_frontier_share) return {};
  BorderEvidence evidence = evidenceOf(border, walls, config.furniture_depth_m);
  if (evidence.num_seen == evidence.lines.size()) return shapeAmong(evidence, cluster, border, config);
  // Where its walls close a room, it does not end where sight did.
  const std::vector<OutlineLine> all = evidence.lines;
  evidence.lines.resize(evidence.num_seen);
  std::optional<RoomShape> closed = shapeAmong(evidence, cluster, border, config);
  if (closed && closed->kind != RoomKind::kInfinite) return closed;
  evidence.lines = all;
  return shapeAmong(evidence, cluster, border, config);
}

}  // namespace sgraphs
