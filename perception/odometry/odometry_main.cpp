#include "common/bus/lcm_bus.h"
#include "tools/system/process.h"
#include "tools/system/stages.h"

namespace sgraphs {
namespace {

std::optional<std::vector<uint8_t>> saved(OdometryNode& node, const SystemConfig& config) {
  if (!node.canSave()) return std::nullopt;
  StateArchive archive;
  std::string config_digest = digestOf(config);
  archive(config_digest);
  node.visitState(archive);
  return archive.takeBytes();
}

void restore(OdometryNode& node, const SystemConfig& config, Bus::Bytes bytes) {
  StateArchive archive(bytes);
  std::string config_digest;
  archive(config_digest);
  if (config_digest != digestOf(config)) throw Error("a checkpoint of another configuration");
  node.visitState(archive);
  if (!archive.atEnd()) throw Error("a checkpoint that holds more than it should");
}

}  // namespace
}  // namespace sgraphs

// LiDAR packets or sweeps, and the legs' odometry, become poses and keyframes on the LCM bus.
int main(int argc, char** argv) {
  using namespace sgraphs;
  const ProcessText text{"sgraphs-odometry", "Scans and the legs' odometry become poses and keyframes",
                         "sgraphs-odometry --lcm-url 'udpm://239.255.76.67:7667?ttl=0'", false};
  return runProcess(text, argc, argv, [&text](const ProcessSetup& setup) {
    LcmBus lcm(setup.lcm_url);
    JournalBus bus(lcm, setup.journal, setup.boot);
    OdometryNode node(bus, makeOdometryParts(setup.config), setup.odometry);
    // About 16 s of a VLP-16.
    bus.keepCheckpoints(
        16 << 20, [&] { return saved(node, setup.config); },
        [&](Bus::Bytes bytes) { restore(node, setup.config, bytes); });
    LoopHooks hooks;
    hooks.done = [&node] { return node.done(); };
    hooks.publish_status = [&node] { node.publishStatus(); };
    hooks.finish = [&node](const std::string& why) { node.finish(why); };
    runLoop(bus, setup, hooks);
    return leaveAfterEnd(
        text, [&node] { node.repeatEnd(); }, node.whyNot());
  });
}
