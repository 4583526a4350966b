#pragma once

#include <string>
#include <vector>

#include "common/types/free_space.h"
#include "perception/free_space/clusters/segmentation.h"
#include "tests/perception/free_space/clusters/plan_grid.h"

namespace sgraphs {

struct RoomScore {
  std::string id;
  double iou = 0;  // with the region that holds most of it
  int32_t region = kNoLabel;
};

// Each true room of the view's storey against the regions of a segmentation, by cells.
std::vector<RoomScore> scoreRooms(const simulate::Scene& scene, const PlanView& view, const StoreyGrid& grid,
                                  const Segmentation& segmentation);

struct DoorScore {
  Eigen::Vector2d place_building = Eigen::Vector2d::Zero();
  double distance_m = 1e9;  // of the nearest passage that is a door
  double width_error_m = 0;
};

// Each true doorway of the storey that leads from room to room.
std::vector<DoorScore> scoreDoors(const simulate::Scene& scene, const PlanView& view,
                                  const Segmentation& segmentation);

}  // namespace sgraphs
