#include "tools/system/stage_process.h"
#include "tools/system/stages.h"

// Free space and walls become rooms, doorways and floors on the LCM bus.
int main(int argc, char** argv) {
  using namespace sgraphs;
  const ProcessText text{"sgraphs-rooms", "Free space and walls become rooms, doorways and floors",
                         "sgraphs-rooms --lcm-url 'udpm://239.255.76.67:7667?ttl=0'", false};
  return runStageProcess<RoomsNode>(text, argc, argv, makeRoomsStep);
}
