#include "common/bus/lcm_bus.h"
#include "tools/system/process.h"
#include "tools/system/stages.h"

// LiDAR packets or sweeps, and the legs' odometry, become poses and keyframes on the LCM bus.
int main(int argc, char** argv) {
  using namespace sgraphs;
  const ProcessText text{"sgraphs-odometry", "Scans and the legs' odometry become poses and keyframes",
                         "sgraphs-odometry --lcm-url 'udpm://239.255.76.67:7667?ttl=0'", false};
  return runProcess(text, argc, argv, [&text](const ProcessSetup& setup) {
    LcmBus lcm(setup.lcm_url);
    JournalBus bus(lcm, setup.journal, setup.boot);
    OdometryNode node(bus, makeOdometryParts(setup.config), setup.odometry);
    LoopHooks hooks;
    hooks.done = [&node] { return node.done(); };
    hooks.publish_status = [&node] { node.publishStatus(); };
    hooks.finish = [&node](const std::string& why) { node.finish(why); };
    runLoop(bus, setup, hooks);
    return leaveAfterEnd(
        text, [&node] { node.repeatEnd(); }, node.whyNot());
  });
}
