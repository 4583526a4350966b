#include <CLI/CLI.hpp>

#include "drivers/spot/spot_bridge_loop.h"

// The odometry of a Spot's legs, over its network interface, on the LCM bus.
int main(int argc, char** argv) {
  using namespace sgraphs;
  SpotBridgeOptions options;
  ProcessText text{
      "sgraphs-spot-bridge", "The odometry of a Spot becomes SPOT_ODOMETRY on the LCM bus",
      "sgraphs-spot-bridge --host 192.168.80.3 --root-cert robot.pem --credentials spot.env\n"
      "User and password: SGRAPHS_SPOT_USER=… and SGRAPHS_SPOT_PASSWORD=… in the credentials file (chmod "
      "600) or in the environment."};
  text.stage = false;
  text.add_options = [&options](CLI::App& app) {
    app.add_option("--host", options.host, "Name or address of the robot");
    app.add_option("--root-cert", options.root_cert, "PEM file of the certificate that signed the robot's");
    app.add_option("--credentials", options.credentials,
                   "File with user and password, readable by its owner only");
    app.add_option("--frame", options.frame, "odom (default) or vision");
    app.add_flag("--session", options.own_session,
                 "Publish SESSION, too, as drivers.session says; default: wait for one on the bus");
  };
  return runProcess(text, argc, argv,
                    [&](const ProcessSetup& setup) { return runSpotBridge(text, setup, options); });
}
