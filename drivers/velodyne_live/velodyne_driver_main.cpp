#include <CLI/CLI.hpp>

#include "drivers/velodyne_live/velodyne_driver_loop.h"

// A VLP-16's UDP packets, or a capture of them played as if live, become messages on the LCM bus.
int main(int argc, char** argv) {
  using namespace sgraphs;
  VelodyneDriverOptions options;
  ProcessText text{"sgraphs-velodyne-driver", "A VLP-16's UDP packets become VELODYNE_PACKETS on the LCM bus",
                   "sgraphs-velodyne-driver --set drivers.velodyne_driver.source_address=192.168.1.201\n"
                   "  sgraphs-velodyne-driver --pcap lidar.pcap --epoch now --set "
                   "'drivers.session.T_body_lidar=0.12 0 0.31 0 0 0 1'"};
  text.stage = false;
  text.add_options = [&options](CLI::App& app) {
    app.add_flag(
        "--no-session", options.no_session,
        "Wait for SESSION from the bus instead of publishing it, and leave STREAM_END to its source");
    app.add_flag("--stream-end", options.stream_end, "Publish STREAM_END at the end although --no-session");
    app.add_flag("--no-stream-end", options.no_stream_end, "Do not publish STREAM_END at the end");
    app.add_option("--pcap", options.pcap, "Play this capture as if its packets arrived now")
        ->check(CLI::ExistingFile);
    app.add_option("--rate", options.rate, "With --pcap: speed, 1 as recorded; 0: as fast as possible")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    app.add_option("--epoch", options.epoch,
                   "With --pcap: 'now' moves its clock to now; default: as captured")
        ->check(CLI::IsMember({"now"}));
    app.add_option("--end-after", options.end_after_s, "Stop after so many seconds; 0: never")
        ->check(CLI::NonNegativeNumber);
  };
  return runProcess(text, argc, argv,
                    [&](const ProcessSetup& setup) { return runVelodyneDriver(text, setup, options); });
}
