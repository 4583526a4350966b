#include "perception/rooms/room_outline.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "perception/rooms/min_cut.h"

namespace sgraphs {
namespace {

constexpr double kWallEnds_m = 0.1;  // walls end earlier in what was seen of them
constexpr double kMinEdge_m = 1e-5;  // shorter edges come of rounding

struct Edge {
  Eigen::Vector2d a, b;
  int line;
};

using CellIndex = std::map<uint64_t, size_t>;

CellIndex indexOf(const std::vector<LineCell>& cells) {
  CellIndex index;
  for (size_t i = 0; i < cells.size(); ++i) index[cells[i].front] = i;
  return index;
}

// The cell beyond edge k; cells.size(): none.
size_t beyond(const std::vector<LineCell>& cells, const CellIndex& index, const LineCell& cell, size_t k) {
  if (cell.lines[k] < 0) return cells.size();
  const auto found = index.find(cell.front ^ (uint64_t{1} << cell.lines[k]));
  return found == index.end() ? cells.size() : found->second;
}

std::vector<bool> insideOf(const std::vector<LineCell>& cells, const CellIndex& index,
                           const std::vector<OutlineLine>& lines, double boundary_cost_m) {
  MinCut cut(cells.size());
  for (size_t i = 0; i < cells.size(); ++i) {
    const LineCell& cell = cells[i];
    double frame_m = 0;
    for (size_t k = 0; k < cell.corners.size(); ++k) {
      const Eigen::Vector2d& a = cell.corners[k];
      const Eigen::Vector2d& b = cell.corners[(k + 1) % cell.corners.size()];
      const size_t other = beyond(cells, index, cell, k);
      if (other == cells.size()) {
        frame_m += (b - a).norm();
        continue;
      }
      const WalledLength walled = walledLength(lines[static_cast<size_t>(cell.lines[k])], a, b);
      // Rooms go on behind low things, as long as there is no better end.
      const double low_m = walled.all_m - walled.high_m, bare_m = (b - a).norm() - walled.all_m;
      cut.addPair(i, other, boundary_cost_m * std::max(0.0, bare_m + 2 * low_m));
    }
    cut.addNode(i, cell.area_m2 - cell.covered_m2 + boundary_cost_m * frame_m, cell.covered_m2);
  }
  return cut.inside();
}

// Only the part of the cells inside that is connected over edges and covers most.
void keepLargest(const std::vector<LineCell>& cells, const CellIndex& index, std::vector<bool>& inside) {
  std::vector<int> part(cells.size(), -1);
  std::vector<double> covered_m2;
  for (size_t seed = 0; seed < cells.size(); ++seed) {
    if (!inside[seed] || part[seed] >= 0) continue;
    const int name = static_cast<int>(covered_m2.size());
    covered_m2.push_back(0);
    std::vector<size_t> open{seed};
    part[seed] = name;
    while (!open.empty()) {
      const size_t i = open.back();
      open.pop_back();
      covered_m2.back() += cells[i].covered_m2;
      for (size_t k = 0; k < cells[i].corners.size(); ++k) {
        const size_t other = beyond(cells, index, cells[i], k);
        if (other == cells.size() || !inside[other] || part[other] >= 0) continue;
        part[other] = name;
        open.push_back(other);
      }
    }
  }
  const auto largest = std::max_element(covered_m2.begin(), covered_m2.end());
  const int kept = static_cast<int>(largest - covered_m2.begin());
  for (size_t i = 0; i < cells.size(); ++i) inside[i] = inside[i] && part[i] == kept;
}

std::vector<Edge> boundaryOf(const std::vector<LineCell>& cells, const CellIndex& index,
                             const std::vector<bool>& inside) {
  std::vector<Edge> edges;
  for (size_t i = 0; i < cells.size(); ++i) {
    if (!inside[i]) continue;
    for (size_t k = 0; k < cells[i].corners.size(); ++k) {
      const size_t other = beyond(cells, index, cells[i], k);
      if (other < cells.size() && inside[other]) continue;
      const Edge edge{cells[i].corners[k], cells[i].corners[(k + 1) % cells[i].corners.size()],
                      cells[i].lines[k]};
      if ((edge.b - edge.a).norm() > kMinEdge_m) edges.push_back(edge);
    }
  }
  return edges;
}

// The edge to go on with: the one that begins nearest; where two parts touch in a corner, the one that turns
// left most, so that the loop does not cross itself.
size_t nextEdge(const std::vector<Edge>& edges, const std::vector<bool>& used, const Edge& last) {
  constexpr double kSamePlace_m = 1e-4;
  size_t best = edges.size();
  double best_distance = 0, best_turn = 0;
  for (size_t i = 0; i < edges.size(); ++i) {
    if (used[i]) continue;
    const double distance = (edges[i].a - last.b).norm();
    const Eigen::Vector2d u = last.b - last.a, v = edges[i].b - edges[i].a;
    const double turn = std::atan2(cross(u, v), u.dot(v));
    const bool nearer = best == edges.size() || distance < best_distance - kSamePlace_m;
    const bool sharper = best < edges.size() && distance < best_distance + kSamePlace_m && turn > best_turn;
    if (!nearer && !sharper) continue;
    best = i;
    best_distance = distance;
    best_turn = turn;
  }
  return best_distance < kSamePlace_m ? best : edges.size();
}

std::vector<std::vector<Edge>> loopsOf(const std::vector<Edge>& edges) {
  std::vector<std::vector<Edge>> loops;
  std::vector<bool> used(edges.size(), false);
  for (size_t first = 0; first < edges.size(); ++first) {
    if (used[first]) continue;
    std::vector<Edge> loop;
    for (size_t i = first; i < edges.size(); i = nextEdge(edges, used, loop.back())) {
      used[i] = true;
      loop.push_back(edges[i]);
      if (i != first && (edges[i].b - edges[first].a).norm() < 1e-4) break;
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

std::vector<OutlineCorner> cornersOf(const std::vector<Edge>& loop) {
  std::vector<OutlineCorner> corners;
  for (size_t i = 0; i < loop.size(); ++i)
    if (loop[i].line != loop[(i + loop.size() - 1) % loop.size()].line)
      corners.push_back({loop[i].a, loop[i].line});
  return corners;
}

double joinedLength(std::vector<std::pair<double, double>> pieces) {
  std::sort(pieces.begin(), pieces.end());
  double length = 0, reached = -std::numeric_limits<double>::infinity();
  for (const auto& [begin, end] : pieces) {
    length += std::max(0.0, end - std::max(begin, reached));
    reached = std::max(reached, end);
  }
  return length;
}

Polygon2d polygonOf(const std::vector<OutlineCorner>& corners) {
  Polygon2d polygon;
  for (const OutlineCorner& corner : corners) polygon.push_back(corner.position_map);
  return polygon;
}

}  // namespace

WalledLength walledLength(const OutlineLine& line, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d inward(a.y() - b.y(), b.x() - a.x());
  std::vector<std::pair<double, double>> high, all;
  for (const Wall& wall : line.walls) {
    if (wall.normal.dot(inward) <= 0) continue;
    const double begin = std::max(wall.along.dot(a), wall.begin_m - kWallEnds_m);
    const double end = std::min(wall.along.dot(b), wall.end_m + kWallEnds_m);
    if (begin >= end) continue;
    all.emplace_back(begin, end);
    if (!wall.low) high.emplace_back(begin, end);
  }
  const double length = (b - a).norm();
  return {std::min(length, joinedLength(std::move(high))), std::min(length, joinedLength(std::move(all)))};
}

RoomOutline outlineOf(const ClusterBorder& border, const BorderEvidence& evidence, double boundary_cost_m) {
  RoomOutline outline;
  if (border.polygon.size() < 3) return outline;
  Eigen::AlignedBox2d frame;
  std::vector<Polygon2d> parts{border.polygon};
  parts.insert(parts.end(), evidence.furniture.begin(), evidence.furniture.end());
  for (const Polygon2d& part : parts)
    for (const Eigen::Vector2d& p : part) frame.extend(p);
  // Room for an outline along the outermost walls.
  frame.extend(Eigen::Vector2d(frame.min().array() - 0.5)).extend(Eigen::Vector2d(frame.max().array() + 0.5));

  const std::vector<LineCell> cells = cellsOf(frame, evidence.lines, parts);
  const CellIndex index = indexOf(cells);
  std::vector<bool> inside = insideOf(cells, index, evidence.lines, boundary_cost_m);
  keepLargest(cells, index, inside);
  for (size_t i = 0; i < cells.size(); ++i)
    (inside[i] ? outline.covered_m2 : outline.left_out_m2) += cells[i].covered_m2;

  double largest_m2 = 0;
  for (const std::vector<Edge>& loop : loopsOf(boundaryOf(cells, index, inside))) {
    std::vector<OutlineCorner> corners = cornersOf(loop);
    const double area_m2 = polygonArea(polygonOf(corners));
    if (corners.size() < 3 || area_m2 <= largest_m2) continue;
    largest_m2 = area_m2;
    outline.corners = std::move(corners);
  }
  return outline;
}

}  // namespace sgraphs
