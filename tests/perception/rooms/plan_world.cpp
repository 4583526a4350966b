#include "tests/perception/rooms/plan_world.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tests/perception/rooms/free_cells.h"
#include "tools/simulate/scene/find_scene.h"
#include "tools/simulate/scene/scene_file.h"

namespace sgraphs::test {
namespace {

using simulate::Scene;

constexpr double kWalkerBody_m = 0.52;
constexpr double kJoin_m = 1.2;  // gaps that a map's extents bridge

struct Face {
  Eigen::Vector2d a, b;  // the room on the left
  FloorId floor;
};

class Builder {
 public:
  Builder(const Scene& scene, const WorldOptions& options)
      : scene_(scene), options_(options), rotation_(options.heading_rad) {}

  PlanWorld build() {
    addFaces();
    addRooms();
    addPassages();
    addKeyframes();
    for (const Face& face : faces_) {
      const double z = scene_.floors_z_m[static_cast<size_t>(face.floor.value)];
      const PlaneId id{static_cast<int64_t>(world_.update.planes.size())};
      world_.update.planes.push_back(wallPlane(id, toMap(face.a), toMap(face.b), z + 0.1, z + 2.6));
    }
    addFurniture();
    addFloors();
    return std::move(world_);
  }

 private:
  Eigen::Vector2d toMap(const Eigen::Vector2d& p) const { return rotation_ * p + options_.offset_m; }

  // A wall (or a mesh, of which all rooms' edges are taken for walls) whose face is at p.
  bool isWalled(const Eigen::Vector2d& p, const Eigen::Vector2d& along, double z) const {
    if (!scene_.meshes.empty()) return true;
    return std::any_of(scene_.walls.begin(), scene_.walls.end(), [&](const simulate::Wall& wall) {
      return !wall.glass && std::abs(along.dot((wall.b - wall.a).normalized())) > 0.99 &&
             wall.z_min_m < z + 1 && wall.z_max_m > z + 1 &&
             std::abs(distanceToSegment(p, wall.a, wall.b) - 0.5 * wall.thickness_m) < 0.06;
    });
  }

  void addFaces() {
    for (const simulate::Room& room : scene_.rooms) {
      const double z = scene_.floors_z_m[static_cast<size_t>(room.floor)];
      for (size_t i = 0; i < room.polygon.size(); ++i) {
        const Eigen::Vector2d a = room.polygon[i], b = room.polygon[(i + 1) % room.polygon.size()];
        const int n = std::max(2, static_cast<int>((b - a).norm() / 0.1));
        int first = -1, last = -1;
        for (int k = 0; k < n; ++k)
          if (isWalled(a + (b - a) * (k + 0.5) / n, (b - a).normalized(), z)) {
            if (first < 0) first = k;
            last = k;
          }
        if (first < 0) continue;
        join({a + (b - a) * first / n, a + (b - a) * (last + 1) / n, FloorId{room.floor}});
      }
    }
  }

  // Faces on one line that face the same way become one where the gap between them is small.
  void join(Face face) {
    for (auto it = faces_.begin(); it != faces_.end();) {
      const Eigen::Vector2d u = (face.b - face.a).normalized(), n(-u.y(), u.x());
      const bool on_line = std::abs(n.dot(it->a - face.a)) < 0.03 && std::abs(n.dot(it->b - face.a)) < 0.03 &&
                           u.dot((it->b - it->a).normalized()) > 0.999 && it->floor == face.floor;
      const double begin = u.dot(it->a - face.a), end = u.dot(it->b - face.a),
                   length = (face.b - face.a).norm();
      if (!on_line || begin > length + kJoin_m || end < -kJoin_m) {
        ++it;
        continue;
      }
      const Eigen::Vector2d origin = face.a;
      face.a = origin + std::min(0.0, begin) * u;
      face.b = origin + std::max(length, end) * u;
      it = faces_.erase(it);
    }
    faces_.push_back(face);
  }

  void addRooms() {
    for (const simulate::Room& room : scene_.rooms) {
      TrueRoom truth{room.id, FloorId{room.floor}, ClusterId{static_cast<int64_t>(world_.rooms.size())}, {}};
      for (const Eigen::Vector2d& p : room.polygon) truth.polygon_map.push_back(toMap(p));
      world_.rooms.push_back(truth);
      FreeSpaceCluster cluster = freeCellsOf(scene_, room, options_.cell_m, rotation_, options_.offset_m);
      cluster.id = truth.cluster;
      cluster.floor = truth.floor;
      cluster.is_corridor = room.id.rfind("C_", 0) == 0 || room.id.rfind("corridor", 0) == 0;
      world_.free_space.clusters[cluster.id] = cluster;
    }
  }

  ClusterId clusterAt(const Eigen::Vector2d& p, int floor) const {
    for (size_t i = 0; i < scene_.rooms.size(); ++i)
      if (scene_.rooms[i].floor == floor && contains(scene_.rooms[i].polygon, p))
        return ClusterId{static_cast<int64_t>(i)};
    return {};
  }

  bool isInRoom(const Eigen::Vector2d& p, double z) const {
    return std::any_of(scene_.rooms.begin(), scene_.rooms.end(), [&](const simulate::Room& room) {
      const double off = z - scene_.floors_z_m[static_cast<size_t>(room.floor)];
      return off > -0.1 && off < 2.5 && contains(room.polygon, p);
    });
  }

  void addPassages() {
    for (const simulate::Doorway& door : scene_.doorways) {
      const Doorframe frame = doorframeOf(scene_, door);
      const Eigen::Vector2d p = door.xyz.head<2>(), off = (0.5 * frame.thickness_m + 0.2) * frame.normal;
      ClusterId a = clusterAt(p + off, door.floor), b = clusterAt(p - off, door.floor);
      if (!a.valid() || !b.valid()) continue;
      if (b < a) std::swap(a, b);
      Passage passage{PassageId{static_cast<int64_t>(world_.free_space.passages.size())}, FloorId{door.floor},
                      a, b};
      // Found 0.15 m from the middle of the wall, as grids have it.
      const Eigen::Vector2d half = 0.5 * door.width_m * frame.along, slip = 0.15 * frame.normal;
      passage.left_map = toMap(p - half + slip).cast<float>();
      passage.right_map = toMap(p + half + slip).cast<float>();
      passage.z_m = static_cast<float>(door.xyz.z());
      world_.free_space.passages[passage.id] = passage;
      world_.doorways.push_back({passage.floor, toMap(p), door.width_m});
    }
  }

  // Through the storeys from below; between them up a flight.
  void addKeyframes() {
    int64_t id = 0;
    for (size_t floor = 0; floor < scene_.floors_z_m.size(); ++floor) {
      const double z = scene_.floors_z_m[floor] + kWalkerBody_m;
      if (floor > 0) {
        const double below = scene_.floors_z_m[floor - 1] + kWalkerBody_m;
        for (int i = 1; i <= 8; ++i) addKeyframe(id, {-50.0 + 0.8 * i, 0.0}, below + (z - below) * i / 8);
        for (int i = 0; i < 4; ++i) addKeyframe(id, {-44.0 + 0.8 * i, 0.0}, z);
      }
      for (const simulate::Room& room : scene_.rooms)
        if (room.floor == static_cast<int>(floor)) addKeyframe(id, innerPoint(room.polygon), z);
    }
    world_.update.newest = KeyframeId{id - 1};
  }

  // The middle of the longest row of the polygon.
  static Eigen::Vector2d innerPoint(const Polygon2d& polygon) {
    Eigen::Vector2d center = polygonCentroid(polygon);
    if (contains(polygon, center)) return center;
    for (double r = 0.1; r < 20; r += 0.1)
      for (int k = 0; k < 16; ++k) {
        Eigen::Vector2d p = center + r * Eigen::Vector2d(std::cos(k * M_PI / 8), std::sin(k * M_PI / 8));
        if (contains(polygon, p)) return p;
      }
    return center;
  }

  void addKeyframe(int64_t& id, const Eigen::Vector2d& p, double z_m) {
    world_.update.keyframes.push_back(keyframeAt(id++, toMap(p), z_m));
  }

  void addFurniture() {
    for (const simulate::Box& box : scene_.boxes) {
      const Eigen::Rotation2Dd turn(box.yaw_rad);
      const Eigen::Vector2d h = 0.5 * box.size;
      const std::vector<Eigen::Vector2d> corners{
          {h.x(), -h.y()}, {-h.x(), -h.y()}, {-h.x(), h.y()}, {h.x(), h.y()}};
      for (size_t i = 0; i < 4; ++i) {
        const Eigen::Vector2d a = box.center + turn * corners[i],
                              b = box.center + turn * corners[(i + 1) % 4];
        if ((b - a).norm() * (box.z_max_m - box.z_min_m) < 0.5) continue;
        // Backs against a wall are not seen.
        const Eigen::Vector2d out = Eigen::Vector2d(a.y() - b.y(), b.x() - a.x()).normalized();
        if (!isInRoom(0.5 * (a + b) + 0.08 * out, box.z_min_m)) continue;
        const PlaneId id{static_cast<int64_t>(world_.update.planes.size())};
        world_.update.planes.push_back(wallPlane(id, toMap(a), toMap(b), box.z_min_m, box.z_max_m));
      }
    }
  }

  void addFloors() {
    for (const double z : scene_.floors_z_m) {
      MapPlane floor;
      floor.id = PlaneId{static_cast<int64_t>(world_.update.planes.size())};
      floor.centroid_map << options_.offset_m, z;
      for (const Eigen::Vector2d& p : Polygon2d{{-60, -60}, {150, -60}, {150, 100}, {-60, 100}})
        floor.polygon_map.emplace_back(toMap(p).cast<float>().x(), toMap(p).cast<float>().y(),
                                       static_cast<float>(z));
      floor.d = -z;
      world_.update.planes.push_back(floor);
    }
  }

  const Scene& scene_;
  WorldOptions options_;
  Eigen::Rotation2Dd rotation_;
  std::vector<Face> faces_;
  PlanWorld world_;
};

}  // namespace

PlanWorld worldOf(const Scene& scene, const WorldOptions& options) {
  return Builder(scene, options).build();
}

PlanWorld worldOf(const std::string& scene, const WorldOptions& options) {
  return worldOf(simulate::loadScene(simulate::findScene(scene)), options);
}

// Each room gets walls of its own around it; neighbours share where their faces are a thickness apart.
Scene sceneOf(const std::vector<std::vector<Eigen::Vector2d>>& rooms, double wall_thickness_m) {
  Scene scene;
  for (size_t r = 0; r < rooms.size(); ++r) {
    scene.rooms.push_back({"R" + std::to_string(r), 0, rooms[r]});
    for (size_t i = 0; i < rooms[r].size(); ++i) {
      const Eigen::Vector2d a = rooms[r][i], b = rooms[r][(i + 1) % rooms[r].size()];
      const Eigen::Vector2d u = (b - a).normalized(), out(u.y(), -u.x());
      simulate::Wall wall;
      wall.a = a + 0.5 * wall_thickness_m * (out - u);
      wall.b = b + 0.5 * wall_thickness_m * (out + u);
      wall.thickness_m = wall_thickness_m;
      scene.walls.push_back(wall);
    }
  }
  return scene;
}

MapPlane wallPlane(PlaneId id, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double z_min_m,
                   double z_max_m) {
  MapPlane plane;
  plane.id = id;
  plane.floor = FloorId{0};
  plane.label = PlaneLabel::kX;
  const Eigen::Vector2d u = (b - a).normalized();
  plane.normal_map = {-u.y(), u.x(), 0.0};
  const Eigen::Vector2d middle = 0.5 * (a + b);
  plane.centroid_map = {middle.x(), middle.y(), 0.5 * (z_min_m + z_max_m)};
  plane.d = -plane.normal_map.dot(plane.centroid_map);
  const auto corner = [&plane](const Eigen::Vector2d& p, double z) {
    plane.polygon_map.push_back(Eigen::Vector3d(p.x(), p.y(), z).cast<float>());
  };
  corner(b, z_min_m);
  corner(a, z_min_m);
  corner(a, z_max_m);
  corner(b, z_max_m);
  return plane;
}

MapKeyframe keyframeAt(int64_t id, const Eigen::Vector2d& p, double z_m) {
  MapKeyframe keyframe;
  keyframe.id = KeyframeId{id};
  keyframe.time = Time{id * 1000000};
  keyframe.T_map_body.translation << p, z_m;
  return keyframe;
}

MapUpdate idleRound(int64_t round) {
  MapUpdate update;
  update.round = round;
  update.time = Time{1000000 * round};
  update.idle = true;
  return update;
}

Polygon2d rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

FreeSpaceCluster clusterOf(int64_t id, const Polygon2d& border, const std::vector<BorderKind>& kinds) {
  FreeSpaceCluster cluster;
  cluster.id = ClusterId{id};
  cluster.floor = FloorId{0};
  for (size_t i = 0; i < border.size(); ++i)
    cluster.border.push_back({border[i].cast<float>(), kinds.empty() ? BorderKind::kObstacle : kinds[i]});
  return cluster;
}

double iou(const Polygon2d& a, const Polygon2d& b) {
  const double shared = sharedArea(a, b);
  return shared / (polygonArea(a) + polygonArea(b) - shared);
}

Polygon2d polygonOf(const RoomObservation& room) {
  Polygon2d polygon;
  for (const RoomCorner& corner : room.polygon) polygon.push_back(corner.position_map);
  return polygon;
}

}  // namespace sgraphs::test
