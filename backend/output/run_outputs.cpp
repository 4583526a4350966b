#include "backend/output/run_outputs.h"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "backend/output/dense_trajectory.h"
#include "backend/output/floor_level.h"
#include "backend/output/floor_plan.h"
#include "backend/output/graph_files.h"
#include "backend/output/left_out_walls.h"
#include "backend/output/map_cloud.h"
#include "backend/output/moved_away.h"
#include "backend/output/occupancy_grid.h"
#include "backend/output/summary_json.h"
#include "common/io/ply.h"
#include "common/io/text_file.h"

namespace sgraphs {
namespace {

constexpr double kMapVoxel_m = 0.05;
constexpr double kOccupancyCell_m = 0.05;

void writeMap(const std::vector<MapPoint>& map, const std::string& path) {
  PointCloud cloud;
  cloud.points.reserve(map.size());
  cloud.floors.reserve(map.size());
  for (const MapPoint& point : map) {
    cloud.points.push_back(point.position_map);
    cloud.floors.push_back(static_cast<uint8_t>(std::min<int64_t>(point.floor.value, 255)));
  }
  writePlyPoints(path, cloud);
}

void writeStorey(const SituationalGraph& graph, const std::vector<OdometryEstimate>& scans,
                 const FloorNode& floor, const std::vector<MapPoint>& map, const std::string& out_dir) {
  const std::string name = floor.id.str();
  const FloorPlan plan = makeFloorPlan(graph, floor, map, scans);
  writeFile(out_dir + "/floorplan_" + name + ".svg", floorPlanSvg(plan));
  writeFile(out_dir + "/floorplan_" + name + ".png", floorPlanPng(plan));
  const OccupancyGrid grid = buildOccupancy(graph, floor, kOccupancyCell_m);
  if (grid.cells.empty()) return;  // nothing was seen in the band: map_server refuses an empty image
  const std::string image = "occupancy_" + name + ".pgm";
  writeFile(out_dir + "/" + image, occupancyPgm(grid));
  writeFile(out_dir + "/occupancy_" + name + ".yaml", occupancyYaml(grid, image));
}

// Of this run alone, with its recording's stamps.
void writeTrajectories(const RunRecord& record, const std::string& out_dir) {
  std::vector<StampedPose> dense = denseTrajectory(*record.graph, record.scans),
                           keyframes = keyframeTrajectory(*record.graph),
                           odometry = odometryTrajectory(record.scans);
  if (const auto& continued = record.continued) {
    const SessionClock& own = continued->sessions.back();
    std::erase_if(keyframes, [&](const StampedPose& p) { return p.time < own.begin; });
    const SE3 T_odom_mapodom = continued->T_mapodom_odom.inverse();
    for (StampedPose& p : odometry) p.pose = T_odom_mapodom * p.pose;
    for (std::vector<StampedPose>* poses : {&dense, &keyframes, &odometry})
      for (StampedPose& p : *poses) p.time = p.time - own.shift;
  }
  writeTum(out_dir + "/trajectory.tum", dense);
  writeTum(out_dir + "/keyframes.tum", keyframes);
  writeTum(out_dir + "/odometry.tum", odometry);
}

}  // namespace

void writeOutputs(const RunRecord& record, const std::string& out_dir) {
  if (!record.graph) throw std::logic_error("writeOutputs: the record has no graph");
  createFolder(out_dir);
  writeTrajectories(record, out_dir);

  const MovedAway moved_away(*record.graph);
  std::set<PlaneId> no_walls = copiesOfWalls(*record.graph);
  no_walls.merge(moved_away.whoWalkedPast(*record.graph));
  const SituationalGraph graph = withoutPlanes(*record.graph, no_walls);
  std::vector<MapPoint> map = buildMap(graph, kMapVoxel_m);
  moved_away.dropFrom(map);
  const std::map<FloorId, FloorNode> floors = describeFloors(graph, map);
  writeMap(map, out_dir + "/map.ply");
  writeFile(out_dir + "/graph.json",
            graphJson(graph, floors, record.keyframe_covariances,
                      record.continued ? record.continued->sessions : std::vector<SessionClock>()));
  writeFile(out_dir + "/graph.g2o", graphG2o(graph));
  if (!graph.keyframes.empty())
    for (const auto& [id, floor] : floors) writeStorey(graph, record.scans, floor, map, out_dir);
  // Last: its presence says that the folder is complete.
  writeFile(out_dir + "/summary.json", summaryJson(record));
}

}  // namespace sgraphs
