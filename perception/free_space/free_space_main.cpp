#include "tools/system/stage_process.h"
#include "tools/system/stages.h"

// Keyframe clouds and the optimised map become free space on the LCM bus.
int main(int argc, char** argv) {
  using namespace sgraphs;
  const ProcessText text{"sgraphs-free-space", "Keyframe clouds and the optimised map become free space",
                         "sgraphs-free-space --lcm-url 'udpm://239.255.76.67:7667?ttl=0'", false};
  return runStageProcess<FreeSpaceNode>(text, argc, argv, makeFreeSpaceStep);
}
