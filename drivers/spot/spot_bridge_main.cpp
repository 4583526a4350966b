#include "drivers/spot/spot_bridge_command.h"

// The odometry of a Spot's legs, over its network interface, on the LCM bus.
int main(int argc, char** argv) {
  return sgraphs::runSpotBridge(argc, argv);
}
