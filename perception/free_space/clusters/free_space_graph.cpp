#include "perception/free_space/clusters/free_space_graph.h"

#include <algorithm>
#include <tuple>

#include "perception/free_space/clusters/axis_graph.h"
#include "perception/free_space/clusters/passable.h"
#include "perception/free_space/clusters/region_border.h"

namespace sgraphs {
namespace {

constexpr double kSamePassage_m = 0.8;  // two doors of one pair of rooms are farther apart
constexpr double kSameVertex_m = 0.4;
// A passage that was found in fewer calls was none, where it is found no more: a wall that was half seen.
constexpr int kKnownPassage = 10;

struct Match {
  double distance_m;
  int64_t former;
  size_t found;
  auto operator<=>(const Match&) const = default;
};

// The nearest first, one to one.
std::map<size_t, int64_t> oneToOne(std::vector<Match> matches) {
  std::sort(matches.begin(), matches.end());
  std::map<size_t, int64_t> former_of;
  std::set<int64_t> used;
  for (const Match& match : matches)
    if (!used.count(match.former) && former_of.emplace(match.found, match.former).second)
      used.insert(match.former);
  return former_of;
}

// Long against its width: an area of 12 squared half widths is three times as long as wide.
bool isCorridor(double area_m2, double widest_m, double aspect) {
  return area_m2 >= 4 * aspect * widest_m * widest_m && widest_m <= 2.0;
}

template <typename Map>
std::vector<typename Map::mapped_type> takeStorey(Map& map, FloorId floor) {
  std::vector<typename Map::mapped_type> taken;
  for (auto it = map.begin(); it != map.end();) {
    if (it->second.floor != floor) {
      ++it;
      continue;
    }
    taken.push_back(it->second);
    it = map.erase(it);
  }
  return taken;
}

// The part of a grid that holds all cells which are free in `like`, with a cell more on each side.
StoreyGrid cropped(const StoreyGrid& grid, const StoreyGrid& like) {
  int x0 = like.width, x1 = -1, y0 = like.height, y1 = -1;
  for (int y = 0; y < like.height; ++y)
    for (int x = 0; x < like.width; ++x) {
      if (like.state[like.index(x, y)] != CellState::kFree) continue;
      x0 = std::min(x0, x);
      x1 = std::max(x1, x);
      y0 = std::min(y0, y);
      y1 = y;
    }
  StoreyGrid part;
  part.floor = grid.floor;
  part.cell_m = grid.cell_m;
  part.surface_z_m = grid.surface_z_m;
  part.origin_map = grid.origin_map;
  if (x1 < 0) return part;
  x0 = std::max(0, x0 - 1);
  y0 = std::max(0, y0 - 1);
  part.width = std::min(grid.width - 1, x1 + 1) - x0 + 1;
  part.height = std::min(grid.height - 1, y1 + 1) - y0 + 1;
  part.origin_map += grid.cell_m * Eigen::Vector2d(x0, y0);
  for (int y = y0; y < y0 + part.height; ++y) {
    const auto begin = static_cast<std::ptrdiff_t>(grid.index(x0, y));
    part.state.insert(part.state.end(), grid.state.begin() + begin, grid.state.begin() + begin + part.width);
    part.clearance_m.insert(part.clearance_m.end(), grid.clearance_m.begin() + begin,
                            grid.clearance_m.begin() + begin + part.width);
  }
  return part;
}

Eigen::Vector2d middleOf(const Passage& passage) {
  return 0.5 * (passage.left_map + passage.right_map).cast<double>();
}

}  // namespace

void FreeSpaceGraph::update(const StoreyGrid& all_rooms, const StoreyGrid& all_navigation) {
  // Grids have wide margins: half of their cells, often.
  const StoreyGrid rooms = cropped(all_rooms, all_rooms), navigation = cropped(all_navigation, all_rooms);
  Storey& storey = storeys_[rooms.floor];
  const Segmentation segmentation = segment(rooms, config_, storey.cuts);
  const std::vector<ClusterId> ids = storey.identity.identify(rooms, segmentation.regions, &next_cluster_);
  storey.cuts.clear();
  for (const RegionPassage& passage : segmentation.passages) storey.cuts.push_back(passage.cut);
  updateClusters(rooms, segmentation, ids);
  updatePassages(rooms, navigation, segmentation, ids);
  updateVertices(rooms, navigation, segmentation, ids);
}

void FreeSpaceGraph::updateClusters(const StoreyGrid& grid, const Segmentation& segmentation,
                                    const std::vector<ClusterId>& ids) {
  takeStorey(result_.clusters, grid.floor);
  std::vector<FreeSpaceCluster> clusters(ids.size());
  for (size_t i = 0; i < grid.state.size(); ++i) {
    const int32_t label = segmentation.regions.labels[i];
    if (label == kNoLabel) continue;
    FreeSpaceCluster& cluster = clusters[static_cast<size_t>(label)];
    cluster.area_m2 += 1;  // in cells
    if (grid.clearance_m[i] <= cluster.max_clearance_m) continue;
    cluster.max_clearance_m = grid.clearance_m[i];
    cluster.center_map = centerOf(grid, i).cast<float>();
  }
  for (const CellLoop& loop : loopsOf(grid, segmentation.regions.labels))
    if (loop.area_m2 > 0) clusters[static_cast<size_t>(loop.label)].border = borderOf(loop, grid.cell_m);
  for (size_t k = 0; k < ids.size(); ++k) {
    FreeSpaceCluster& cluster = clusters[k];
    cluster.id = ids[k];
    cluster.floor = grid.floor;
    cluster.area_m2 *= static_cast<float>(grid.cell_m * grid.cell_m);
    cluster.is_corridor = isCorridor(cluster.area_m2, cluster.max_clearance_m, config_.corridor_aspect);
    result_.clusters[cluster.id] = std::move(cluster);
  }
}

void FreeSpaceGraph::updatePassages(const StoreyGrid& grid, const StoreyGrid& navigation,
                                    const Segmentation& segmentation, const std::vector<ClusterId>& ids) {
  const std::vector<Passage> former = takeStorey(result_.passages, grid.floor);
  std::vector<Passage> found;
  for (const RegionPassage& region : segmentation.passages) {
    Passage passage;
    passage.floor = grid.floor;
    passage.a = ids[static_cast<size_t>(region.a)];
    passage.b = ids[static_cast<size_t>(region.b)];
    passage.left_map = region.cut.left.cast<float>();
    passage.right_map = region.cut.right.cast<float>();
    passage.z_m = static_cast<float>(grid.surface_z_m);
    if (passage.b < passage.a) {
      std::swap(passage.a, passage.b);
      std::swap(passage.left_map, passage.right_map);
    }
    // Between two corridors and without a narrowing, it is a bend or a branch; over a sill, a window.
    passage.is_door = (region.cut.narrows || !result_.clusters[passage.a].is_corridor ||
                       !result_.clusters[passage.b].is_corridor) &&
                      isPassable(navigation, region.cut.left, region.cut.right);
    found.push_back(passage);
  }
  std::vector<Match> matches;
  for (const Passage& old : former)
    for (size_t k = 0; k < found.size(); ++k) {
      const double d_m = (middleOf(old) - middleOf(found[k])).norm();
      const bool same_pair = std::tie(old.a, old.b) == std::tie(found[k].a, found[k].b);
      if (d_m < kSamePassage_m) matches.push_back({same_pair ? d_m : d_m + kSamePassage_m, old.id.value, k});
    }
  const std::map<size_t, int64_t> former_of = oneToOne(std::move(matches));
  std::set<int64_t> seen;
  for (size_t k = 0; k < found.size(); ++k) {
    const auto it = former_of.find(k);
    found[k].id = PassageId{it != former_of.end() ? it->second : next_passage_++};
    seen.insert(found[k].id.value);
    result_.passages[found[k].id] = found[k];
    ++found_[found[k].id];
  }
  // Somebody stands in a doorway, or the door is closed: it is still one while both clusters live, unless its
  // place lies amid one of them now.
  for (const Passage& old : former) {
    if (seen.count(old.id.value) || found_[old.id] < kKnownPassage || !result_.clusters.count(old.a) ||
        !result_.clusters.count(old.b))
      continue;
    const Eigen::Vector2d along = (old.left_map - old.right_map).cast<double>().normalized();
    const Eigen::Vector2d across(-along.y(), along.x());
    const int32_t one = labelAt(grid, segmentation.regions.labels, middleOf(old) + 0.4 * across);
    const int32_t other = labelAt(grid, segmentation.regions.labels, middleOf(old) - 0.4 * across);
    if (one == kNoLabel || one != other) result_.passages[old.id] = old;
  }
  std::erase_if(found_, [this](const auto& item) { return !result_.passages.contains(item.first); });
}

void FreeSpaceGraph::updateVertices(const StoreyGrid& rooms, const StoreyGrid& navigation,
                                    const Segmentation& segmentation, const std::vector<ClusterId>& ids) {
  const std::vector<FreeSpaceVertex> former = takeStorey(result_.vertices, rooms.floor);
  std::vector<Eigen::Vector2d> wanted;
  for (const RegionPassage& passage : segmentation.passages) wanted.push_back(passage.cut.middle());
  const AxisGraph graph = graphAlongAxis(navigation, wanted, config_);
  std::vector<FreeSpaceVertex> vertices(graph.vertices.size());
  for (size_t i = 0; i < vertices.size(); ++i) {
    const size_t cell = graph.vertices[i].cell;
    const int32_t label = segmentation.regions.labels[cell];
    vertices[i].floor = rooms.floor;
    if (label != kNoLabel) vertices[i].cluster = ids[static_cast<size_t>(label)];
    vertices[i].position_map.head<2>() = centerOf(navigation, cell).cast<float>();
    vertices[i].position_map.z() = static_cast<float>(navigation.surface_z_m);
    vertices[i].clearance_m = navigation.clearance_m[cell];
  }
  std::vector<std::pair<float, size_t>> by_x;
  for (size_t k = 0; k < former.size(); ++k) by_x.emplace_back(former[k].position_map.x(), k);
  std::sort(by_x.begin(), by_x.end());
  std::vector<Match> matches;
  for (size_t i = 0; i < vertices.size(); ++i) {
    const float x = vertices[i].position_map.x();
    auto it = std::lower_bound(by_x.begin(), by_x.end(),
                               std::make_pair(x - static_cast<float>(kSameVertex_m), size_t{0}));
    for (; it != by_x.end() && it->first <= x + kSameVertex_m; ++it) {
      const FreeSpaceVertex& old = former[it->second];
      const double d_m = (old.position_map - vertices[i].position_map).head<2>().norm();
      if (d_m <= kSameVertex_m) matches.push_back({d_m, old.id.value, i});
    }
  }
  const std::map<size_t, int64_t> former_of = oneToOne(std::move(matches));
  for (size_t i = 0; i < vertices.size(); ++i) {
    const auto it = former_of.find(i);
    vertices[i].id = VertexId{it != former_of.end() ? it->second : next_vertex_++};
  }
  for (size_t i = 0; i < vertices.size(); ++i) {
    for (const size_t n : graph.vertices[i].neighbours) vertices[i].neighbours.push_back(vertices[n].id);
    std::sort(vertices[i].neighbours.begin(), vertices[i].neighbours.end());
    result_.vertices[vertices[i].id] = vertices[i];
  }
}

}  // namespace sgraphs
