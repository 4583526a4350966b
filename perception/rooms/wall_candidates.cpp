#include "perception/rooms/wall_candidates.h"

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

constexpr double kPiece_m = 0.4;       // borders are looked at in pieces of at most this
constexpr double kBehind_m = 0.3;      // a border may lie so far behind a wall's face: door reveals, noise
constexpr double kEnds_m = 0.15;       // walls end earlier in what was seen of them
constexpr double kFacing = 0.3;        // least cosine between a wall's normal and the border's
constexpr double kMinSupport_m = 0.3;  // of border in front of a wall
constexpr double kSameLine_m = 0.1;    // walls that are one for an outline
constexpr double kSameFace_m = 0.03;
constexpr double kSameLine_cos = 0.9962;  // 5 degrees
constexpr double kExplained_m = 0.25;     // border this near to an outline's line needs none of its own
constexpr double kExplained_cos = 0.94;   // 20 degrees
constexpr double kMinBare_m = 0.6;        // shorter stretches without a wall make no line: people, chairs
// Walls count if they fill a part of the height between knees and head.
constexpr double kBottom_m = 0.2, kTop_m = 1.8, kMinInBand_m = 0.25;
constexpr double kLow_m = 1.1;    // a LiDAR at hip height sees more of a wall
constexpr size_t kMaxLines = 60;  // cells are named by one bit per line

struct Piece {
  BorderEdge edge;
  Eigen::Vector2d middle, outward;
};

std::vector<Piece> piecesOf(const BorderEdge& edge) {
  const int n = std::max(1, static_cast<int>(std::ceil(edge.length() / kPiece_m)));
  std::vector<Piece> pieces;
  for (int i = 0; i < n; ++i) {
    const BorderEdge part{edge.a + (edge.b - edge.a) * i / n, edge.a + (edge.b - edge.a) * (i + 1) / n,
                          edge.kind};
    pieces.push_back({part, part.middle(), edge.outward()});
  }
  return pieces;
}

bool spans(const Wall& wall, const Eigen::Vector2d& p) {
  const double s = wall.along.dot(p);
  return s > wall.begin_m - kEnds_m && s < wall.end_m + kEnds_m;
}

// The other face of a partition: then what comes behind it belongs to the next room.
bool isPartitioned(const Eigen::Vector2d& p, const Wall& wall, const std::vector<Wall>& walls) {
  const Eigen::Vector2d foot = p - wall.distance(p) * wall.normal;
  return std::any_of(walls.begin(), walls.end(), [&](const Wall& other) {
    return other.normal.dot(wall.normal) < -0.9 && spans(other, foot) && other.distance(p) < 0.05 &&
           other.distance(foot) > 0.02;
  });
}

bool standsBehind(const Wall& wall, const Piece& piece, double depth_m) {
  const double distance = wall.distance(piece.middle);
  return distance > -kBehind_m && distance < depth_m && piece.outward.dot(wall.normal) < -kFacing &&
         spans(wall, piece.middle);
}

bool liesOn(const OutlineLine& line, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double gap_m) {
  return std::abs(line.distance(a)) < gap_m && std::abs(line.distance(b)) < gap_m;
}

// Walls on one line within the noise of a map join in it, the longest leads; those that face the other way
// only if they cannot be the two faces of a wall.
std::vector<OutlineLine> joinedLines(std::vector<Wall> walls) {
  std::stable_sort(walls.begin(), walls.end(),
                   [](const Wall& a, const Wall& b) { return a.length() > b.length(); });
  std::vector<OutlineLine> lines;
  for (const Wall& wall : walls) {
    const auto line = std::find_if(lines.begin(), lines.end(), [&wall](const OutlineLine& l) {
      const double cos = l.normal.dot(wall.normal);
      return std::abs(cos) > kSameLine_cos && liesOn(l, wall.pointAt(wall.begin_m), wall.pointAt(wall.end_m),
                                                     cos > 0 ? kSameLine_m : kSameFace_m);
    });
    if (line != lines.end())
      line->walls.push_back(wall);
    else if (lines.size() < kMaxLines)
      lines.push_back({wall.normal, wall.d, {wall}});
  }
  return lines;
}

void addBareLines(std::vector<BorderEdge> bare, std::vector<OutlineLine>& lines) {
  std::stable_sort(bare.begin(), bare.end(),
                   [](const BorderEdge& a, const BorderEdge& b) { return a.length() > b.length(); });
  for (const BorderEdge& edge : bare) {
    const Eigen::Vector2d inward = -edge.outward();
    const bool known = std::any_of(lines.begin(), lines.end(), [&](const OutlineLine& l) {
      return std::abs(l.normal.dot(inward)) > kExplained_cos && liesOn(l, edge.a, edge.b, kExplained_m);
    });
    if (!known && lines.size() < kMaxLines) lines.push_back({inward, -inward.dot(edge.a), {}});
  }
}

}  // namespace

bool StoreyBand::holds(const Wall& wall) const {
  return std::min(top_z_m, wall.top_z_m) - std::max(bottom_z_m, wall.bottom_z_m) >= kMinInBand_m;
}

StoreyBand bandAbove(double surface_z_m) {
  return {surface_z_m + kBottom_m, surface_z_m + kTop_m, surface_z_m + kLow_m};
}

BorderEvidence evidenceOf(const ClusterBorder& border, const std::vector<Wall>& walls,
                          double furniture_depth_m) {
  std::vector<double> support(walls.size(), 0.0);
  std::vector<BorderEdge> bare, frontier;
  BorderEvidence evidence;
  for (const BorderEdge& edge : border.edges) {
    double unexplained_m = 0;
    for (const Piece& piece : piecesOf(edge)) {
      const bool low = std::any_of(walls.begin(), walls.end(), [&](const Wall& wall) {
        return wall.low && standsBehind(wall, piece, kBehind_m);
      });
      const double depth_m = low ? std::max(kLowFurniture_m, furniture_depth_m) : furniture_depth_m;
      const Wall* deepest = nullptr;
      for (size_t i = 0; i < walls.size(); ++i) {
        const Wall& wall = walls[i];
        if (!standsBehind(wall, piece, depth_m) || isPartitioned(piece.middle, wall, walls)) continue;
        if (edge.kind == BorderKind::kObstacle)
          support[i] += std::abs(wall.along.dot(piece.edge.b - piece.edge.a));
        if (!deepest || wall.distance(piece.middle) > deepest->distance(piece.middle)) deepest = &wall;
      }
      if (!deepest) unexplained_m += piece.edge.length();
      if (!deepest || edge.kind == BorderKind::kPassage) continue;
      const double da = deepest->distance(piece.edge.a), db = deepest->distance(piece.edge.b);
      if (da < 0 || db < 0) continue;
      const Eigen::Vector2d& n = deepest->normal;
      evidence.furniture.push_back(
          {piece.edge.a, piece.edge.a - da * n, piece.edge.b - db * n, piece.edge.b});
    }
    if (unexplained_m > 0.5 * edge.length() && edge.length() > kMinBare_m)
      (edge.kind == BorderKind::kFrontier ? frontier : bare).push_back(edge);
  }
  std::vector<Wall> candidates;
  for (size_t i = 0; i < walls.size(); ++i)
    if (support[i] >= kMinSupport_m) candidates.push_back(walls[i]);
  evidence.lines = joinedLines(std::move(candidates));
  addBareLines(std::move(bare), evidence.lines);
  evidence.num_seen = evidence.lines.size();
  addBareLines(std::move(frontier), evidence.lines);
  return evidence;
}

}  // namespace sgraphs
