#include <cstdio>

#include "backend/output/run_outputs.h"
#include "common/base/error.h"
#include "common/bus/lcm_bus.h"
#include "tools/system/process.h"
#include "tools/system/run_record.h"
#include "tools/system/stages.h"

// Keyframes become one optimised graph on the LCM bus, round by round.
int main(int argc, char** argv) {
  using namespace sgraphs;
  const ProcessText text{"sgraphs-backend", "Keyframes become one optimised graph",
                         "sgraphs-backend -o OUT --lcm-url 'udpm://239.255.76.67:7667?ttl=0'", true};
  return runProcess(text, argc, argv, [&text](const ProcessSetup& setup) {
    LcmBus bus(setup.lcm_url);
    BackendNode node(bus, makeBackendCore(setup.config));
    LoopHooks hooks;
    hooks.done = [&node] { return node.done(); };
    hooks.publish_status = [&node] { node.publishStatus(); };
    hooks.finish = [&node](const std::string& why) { node.finish(why); };
    hooks.overdue = [&node] { return node.streamEnded() && !node.done(); };
    hooks.awaited = [&node] { return node.awaitedRound(); };
    hooks.give_up_awaited = [&node] { node.giveUpAwaited(); };
    runLoop(bus, setup, hooks);
    if (!setup.output_dir.empty()) writeOutputs(recordOf(node, setup.config), setup.output_dir);
    std::printf("graph_digest %s\nrounds %lld\n", node.result().graph_digest.c_str(),
                static_cast<long long>(node.result().rounds));
    return leaveAfterEnd(
        text, [&node] { node.repeatEnd(); }, node.result().why_not);
  });
}
