#pragma once

#include <span>
#include <string>
#include <vector>

#include "backend/graph/situational_graph.h"
#include "backend/output/map_cloud.h"
#include "common/io/canvas.h"

namespace sgraphs {

// What one storey's plan shows, in map, metres: how much stands above each cell of ground, and the path.
struct FloorPlan {
  FloorId floor;
  Raster ink;  // grey: the share of the height slice that holds points
  struct PathPoint {
    Eigen::Vector2d position_map;
    double time_s = 0;   // since the run's first scan
    bool joined = true;  // with the point before; false where the robot was on another storey in between
  };
  std::vector<PathPoint> path;
  double duration_s = 0;  // of the whole run: the colour scale's end
  Paper extent;           // of ink and path
};

FloorPlan makeFloorPlan(const SituationalGraph& graph, const FloorNode& floor, std::span<const MapPoint> map,
                        std::span<const OdometryEstimate> scans);

std::string floorPlanPng(const FloorPlan& plan);
std::string floorPlanSvg(const FloorPlan& plan);

}  // namespace sgraphs
