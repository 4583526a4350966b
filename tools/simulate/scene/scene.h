#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/se3.h"
#include "tools/simulate/sensor/fault_model.h"
#include "tools/simulate/sensor/legs_model.h"
#include "tools/simulate/sensor/sensor_model.h"
#include "tools/simulate/walk/walk.h"

namespace sgraphs::simulate {

// A building and a walk through it, in the building's frame: metres, z up. config/scenes/README.md describes
// the file they come from.

// Upright wall around the centre line from a to b; its ends are cut square at a and b, so that walls whose
// centre lines meet overlap and leave no gap.
struct Wall {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  double thickness_m = 0.1;
  double z_min_m = 0;
  double z_max_m = 2.8;
  bool glass = false;  // a pane: see RayCaster

  double length() const { return (b - a).norm(); }
};

// Opening in the wall on whose centre line it stands.
struct Doorway {
  int floor = 0;
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();  // middle of the threshold
  double width_m = 0.95;
  double height_m = 2.1;  // above the threshold; the wall above it is the lintel
};

// Hole in a wall that nobody walks through: a window, a hatch, a gap in an unfinished wall. Like a doorway,
// it belongs to the wall on whose centre line the middle of its lower edge stands.
struct Window {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  double width_m = 1.2;
  double height_m = 1.2;  // above xyz
  bool glazed = false;    // filled with a pane of glass
};

struct Room {
  std::string id;  // ids that begin with C_ or corridor are corridors (contract.md)
  int floor = 0;
  std::vector<Eigen::Vector2d> polygon;  // along the inner faces of the walls, counter-clockwise
};

// Furniture: an upright box.
struct Box {
  std::string name;
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  Eigen::Vector2d size = Eigen::Vector2d::Ones();
  double z_min_m = 0;
  double z_max_m = 1;
  double yaw_rad = 0;
};

// Upright cylinder, as a prism.
struct Column {
  std::string name;
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double radius_m = 0.2;
  double z_min_m = 0;
  double z_max_m = 2.8;
};

// A straight flight of solid steps, from the middle of its lowest front edge to the middle of its highest
// back edge; the step at the top is level with z_max.
struct Stairs {
  Eigen::Vector2d foot = Eigen::Vector2d::Zero();
  Eigen::Vector2d top = Eigen::Vector2d::Zero();
  double width_m = 1.2;
  double z_min_m = 0;
  double z_max_m = 3;
  int steps = 17;
};

// The door of a lift, the same on each floor where the lift stops; it stands in a doorway of each floor. The
// car's walls are walls of the plan: they must be the same on each floor, as a rider sees nothing else.
struct Lift {
  std::string name;
  std::vector<int> floors;
  Eigen::Vector2d door_a = Eigen::Vector2d::Zero();  // jambs: two leaves meet half-way
  Eigen::Vector2d door_b = Eigen::Vector2d::Zero();
  double door_height_m = 2.1;
};

// Somebody who walks to and fro along a line, or stands (one waypoint); seen by the sensor, not in the mesh.
struct Person {
  int floor = 0;
  std::vector<Eigen::Vector2d> waypoints;
  double speed_mps = 1.2;
  double start_s = 0;  // stands at the first waypoint before
  double radius_m = 0.22;
  double height_m = 1.75;
};

// A building from a file instead of walls, or beside them.
struct MeshFile {
  std::string path;  // PLY, OBJ, STL, DAE by assimp; SDF by its boxes; relative to the plan
  double scale = 1;
  SE3 T_building_mesh;
};

// Floor or ceiling: a box parallel to the axes.
struct Slab {
  Eigen::Vector2d min = Eigen::Vector2d::Zero();
  Eigen::Vector2d max = Eigen::Vector2d::Zero();
  double z_min_m = 0;
  double z_max_m = 0;
};

struct Scene {
  std::string name;
  Time start{1700000000000000};  // of the first firing
  std::vector<double> floors_z_m{0.0};
  std::vector<Wall> walls;
  std::vector<Doorway> doorways;
  std::vector<Window> windows;
  std::vector<Room> rooms;
  std::vector<Box> boxes;
  std::vector<Column> columns;
  std::vector<Stairs> stairs;
  std::vector<Lift> lifts;
  std::vector<Person> people;
  std::vector<Slab> slabs;
  std::vector<MeshFile> meshes;
  SE3 T_body_lidar{Eigen::Quaterniond::Identity(), {0.12, 0.0, 0.31}};
  SensorModel sensor;
  LegsOdometryModel legs;
  FaultModel faults;
  int path_floor = 0;
  WalkPath path;
};

}  // namespace sgraphs::simulate
