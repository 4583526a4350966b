#include "common/base/error.h"
#include "common/bus/lcm_bus.h"
#include "tools/system/process.h"
#include "tools/system/stages.h"

// Free space and walls become rooms, doorways and floors on the LCM bus.
int main(int argc, char** argv) {
  using namespace sgraphs;
  const ProcessText text{"sgraphs-rooms", "Free space and walls become rooms, doorways and floors",
                         "sgraphs-rooms --lcm-url 'udpm://239.255.76.67:7667?ttl=0'", false};
  return runProcess(text, argc, argv, [](const ProcessSetup& setup) {
    LcmBus bus(setup.lcm_url);
    RoomsNode node(bus, makeRoomsStep(setup.config));
    LoopHooks hooks;
    hooks.done = [&node] { return node.done(); };
    hooks.publish_status = [&node] { node.publishStatus(); };
    hooks.finish = [&node](const std::string&) { node.finish(); };
    hooks.overdue = [&node] { return node.streamEnded() && !node.done(); };
    runLoop(bus, setup, hooks);
    return kExitDone;
  });
}
