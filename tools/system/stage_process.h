#pragma once

#include "common/base/error.h"
#include "common/bus/lcm_bus.h"
#include "tools/system/process.h"

namespace sgraphs {

// The process of a stage that answers the backend's rounds and ends with RUN_RESULT.
// `make_step`: the stage's core from a SystemConfig.
template <typename Node, typename MakeStep>
int runStageProcess(const ProcessText& text, int argc, char** argv, MakeStep make_step) {
  return runProcess(text, argc, argv, [make_step](const ProcessSetup& setup) {
    LcmBus lcm(setup.lcm_url);
    JournalBus bus(lcm, setup.journal, setup.boot);
    Node node(bus, make_step(setup.config));
    LoopHooks hooks;
    hooks.done = [&node] { return node.done(); };
    hooks.publish_status = [&node] { node.publishStatus(); };
    hooks.finish = [&node](const std::string&) { node.finish(); };
    hooks.overdue = [&node] { return node.streamEnded() && !node.done(); };
    runLoop(bus, setup, hooks);
    return static_cast<int>(kExitDone);
  });
}

}  // namespace sgraphs
