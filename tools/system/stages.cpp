#include "tools/system/stages.h"

#include <utility>

#include "backend/backend.h"
#include "perception/free_space/free_space_mapper.h"
#include "perception/loops/loop_finder.h"
#include "perception/odometry/odometry.h"
#include "perception/planes/plane_segmentation.h"
#include "perception/rooms/room_finder.h"

namespace sgraphs {

std::vector<std::string> allStages() {
  return {"odometry", "planes", "free-space", "rooms", "loops", "backend"};
}

OdometryParts makeOdometryParts(const SystemConfig& config, const std::shared_ptr<Vlp16Counts>& counts) {
  OdometryParts parts;
  struct Made {
    std::shared_ptr<RevolutionAssembler> decoder;
    std::shared_ptr<Odometry> odometry;
  };
  const auto made = std::make_shared<Made>();
  parts.make_decoder = [counts, made] {
    const auto decoder = made->decoder = std::make_shared<RevolutionAssembler>();
    return [decoder, counts](const VelodynePacket& packet) {
      std::optional<LidarScan> scan = decoder->step(packet.time, packet.bytes);
      if (counts) *counts = decoder->counts();
      return scan;
    };
  };
  parts.make_step = [config, made](OdometryMode mode, const SE3& T_body_lidar) {
    const auto odometry = made->odometry = std::make_shared<Odometry>(config.odometry, mode, T_body_lidar);
    return OdometryParts::Step{[odometry](const LidarScan& scan, std::span<const BodyOdometry> samples) {
                                 return odometry->step(scan, samples);
                               },
                               [odometry] { return odometry->takeKeyframe(); }};
  };
  parts.visit_state = [made](StateArchive& archive) { archive(*made->decoder, *made->odometry); };
  parts.clock = config.odometry.clock;
  return parts;
}

PlanesNode::Step makePlanesStep(const SystemConfig& config) {
  return [segmentation = PlaneSegmentation(config.planes)](const Keyframe& keyframe) {
    return segmentation.step(keyframe);
  };
}

FreeSpaceNode::Step makeFreeSpaceStep(const SystemConfig& config) {
  auto mapper = std::make_shared<FreeSpaceMapper>(config.free_space);
  return [mapper](const std::optional<Keyframe>& keyframe, const MapUpdate& update) -> const FreeSpace& {
    return mapper->step(keyframe, update);
  };
}

RoomsNode::Step makeRoomsStep(const SystemConfig& config) {
  auto finder = std::make_shared<RoomFinder>(config.rooms);
  return [finder](const FreeSpace& free_space, const MapUpdate& update) {
    return finder->step(free_space, update);
  };
}

LoopsNode::Step makeLoopsStep(const SystemConfig& config) {
  auto finder = std::make_shared<LoopFinder>(config.loops);
  return [finder](const std::optional<Keyframe>& keyframe, const MapUpdate& update) {
    return finder->step(keyframe, update);
  };
}

BackendCore makeBackendCore(const SystemConfig& config) {
  auto backend = std::make_shared<Backend>(config.backend);
  return {[backend](RoundInput input) { return backend->step(std::move(input)); },
          [backend]() -> const SituationalGraph& { return backend->graph(); },
          [backend] { return backend->factorStatistics(); },
          [backend] { return backend->keyframeCovariances(); }};
}

std::string describeRefused(const Vlp16Counts& counts) {
  std::string text;
  for (int fault = 1; fault < kNumPacketFaults; ++fault)
    if (const int64_t n = counts.rejected[static_cast<size_t>(fault)]; n > 0)
      text += (text.empty() ? "" : "; ") + std::to_string(n) +
              " packet(s): " + toString(static_cast<PacketFault>(fault));
  return text;
}

}  // namespace sgraphs
