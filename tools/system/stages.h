#pragma once

#include <memory>
#include <string>
#include <vector>

#include "backend/backend_node.h"
#include "drivers/velodyne/vlp16_decoder.h"
#include "perception/free_space/free_space_node.h"
#include "perception/loops/loops_node.h"
#include "perception/odometry/odometry_node.h"
#include "perception/planes/planes_node.h"
#include "perception/rooms/rooms_node.h"
#include "tools/system/system_config.h"

namespace sgraphs {

// The stages of the whole graph, as SESSION names them.
std::vector<std::string> allStages();

// The real cores for the nodes. `counts` (optional) receives what the VLP-16 decoder counted.
OdometryParts makeOdometryParts(const SystemConfig& config,
                                const std::shared_ptr<Vlp16Counts>& counts = nullptr);
PlanesNode::Step makePlanesStep(const SystemConfig& config);
FreeSpaceNode::Step makeFreeSpaceStep(const SystemConfig& config);
RoomsNode::Step makeRoomsStep(const SystemConfig& config);
LoopsNode::Step makeLoopsStep(const SystemConfig& config);
BackendCore makeBackendCore(const SystemConfig& config);

// "3 packets: wrong block flag; …"; empty if none was refused.
std::string describeRefused(const Vlp16Counts& counts);

}  // namespace sgraphs
