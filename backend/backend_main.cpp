#include <cstdio>
#include <vector>

#include "backend/output/run_outputs.h"
#include "common/base/error.h"
#include "common/bus/lcm_bus.h"
#include "tools/system/process.h"
#include "tools/system/run_record.h"
#include "tools/system/stages.h"

namespace {

// The only decisions by wall clock. A live round goes on without late feedback, which joins a later one; at
// the end of the stream nothing is in a hurry any more. What does not come at all was lost.
std::vector<sgraphs::Awaited> awaitedBy(sgraphs::BackendNode& node, sgraphs::JournalBus& bus,
                                        const sgraphs::ProcessSetup& setup) {
  using namespace sgraphs;
  // What a clock decides stands in the journal, in its place among the messages.
  const auto by_clock = [&bus](const std::string& name, const std::function<void()>& decide) {
    bus.onNote(name, decide);
    return [&bus, name] { bus.note(name); };
  };
  const auto lost_after = [] { return kLostAfter_s; };
  std::vector<Awaited> awaited;
  awaited.push_back(
      {[&node] { return node.awaitedRound(); }, lost_after,
       by_clock("give up", [&node] { node.giveUpAwaited(); }),
       "is the newest round: an answer to its map did not arrive within 10 s; the next one goes on without"});
  if (!setup.live) return awaited;
  awaited.push_back({[&node] { return node.inputEnded() ? -1 : node.awaitedRound(); },
                     [s = setup.config.live.deadline_s] { return s; },
                     by_clock("leave out", [&node] { node.leaveOutAwaited(); }), ""});
  awaited.push_back({[&node] { return node.awaitedPlanes(); }, lost_after,
                     by_clock("give up planes", [&node] { node.giveUpPlanes(); }),
                     "is a keyframe whose planes did not arrive within 10 s; its round goes on without"});
  return awaited;
}

}  // namespace

// Keyframes become one optimised graph on the LCM bus, round by round.
int main(int argc, char** argv) {
  using namespace sgraphs;
  const ProcessText text{"sgraphs-backend", "Keyframes become one optimised graph",
                         "sgraphs-backend -o OUT --lcm-url 'udpm://239.255.76.67:7667?ttl=0'", true, true};
  return runProcess(text, argc, argv, [&text](const ProcessSetup& setup) {
    LcmBus lcm(setup.lcm_url);
    JournalBus bus(lcm, setup.journal, setup.boot);
    BackendNode node(bus, makeBackendCore(setup.config),
                     setup.live ? RoundJoiner::Mode::kLive : RoundJoiner::Mode::kWait);
    LoopHooks hooks;
    hooks.done = [&node] { return node.done(); };
    hooks.publish_status = [&node] { node.publishStatus(); };
    hooks.finish = [&node](const std::string& why) { node.finish(why); };
    hooks.overdue = [&node] { return node.streamEnded() && !node.done(); };
    hooks.awaited = awaitedBy(node, bus, setup);
    runLoop(bus, setup, hooks);
    if (!setup.output_dir.empty()) writeOutputs(recordOf(node, setup.config), setup.output_dir);
    std::printf("graph_digest %s\nrounds %lld\n", node.result().graph_digest.c_str(),
                static_cast<long long>(node.result().rounds));
    return leaveAfterEnd(
        text, [&node] { node.repeatEnd(); }, node.result().why_not);
  });
}
