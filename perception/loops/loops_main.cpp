#include "tools/system/stage_process.h"
#include "tools/system/stages.h"

// Keyframe clouds and the optimised map become loop closures on the LCM bus.
int main(int argc, char** argv) {
  using namespace sgraphs;
  const ProcessText text{"sgraphs-loops", "Keyframe clouds and the optimised map become loop closures",
                         "sgraphs-loops --lcm-url 'udpm://239.255.76.67:7667?ttl=0'", false};
  return runStageProcess<LoopsNode>(text, argc, argv, makeLoopsStep);
}
