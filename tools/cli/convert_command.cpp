#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <memory>

#include "common/base/error.h"
#include "drivers/recording/convert_recording.h"
#include "tools/cli/commands.h"

namespace sgraphs::cli {
namespace {

struct ConvertArguments {
  ConvertOptions options;
  std::string T_body_lidar;
  int64_t start_utime = 0;
};

// A line on a terminal that is overwritten; silent for what takes less than two seconds.
class ProgressLine {
 public:
  void update(double share) {
    const double elapsed_s = std::chrono::duration<double>(Clock::now() - begin_).count();
    if (!terminal_ || elapsed_s < shown_s_ + (shown_s_ > 0 ? 0.2 : 2.0)) return;
    shown_s_ = elapsed_s;
    std::fprintf(stderr, "\rconverting %3.0f %%", 100 * share);
    std::fflush(stderr);
  }
  ~ProgressLine() {
    if (shown_s_ > 0) std::fprintf(stderr, "\r%20s\r", "");
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
  double shown_s_ = 0;
  bool terminal_ = isatty(STDERR_FILENO) != 0;
};

void row(const char* name, int64_t value, const char* note = "") {
  std::printf("  %-32s %10lld%s\n", name, static_cast<long long>(value), note);
}

void printTopics(const ConvertReport& report) {
  const ChosenTopics& topics = report.topics;
  if (!topics.lidar.name.empty())
    std::printf("  LiDAR %s (%s)\n", topics.lidar.name.c_str(), topics.lidar.type.c_str());
  if (!topics.odometry.name.empty())
    std::printf("  odometry %s (%s), of frame '%s', which is the body\n", topics.odometry.name.c_str(),
                topics.odometry.type.c_str(), report.body_frame.c_str());
}

void printReport(const ConvertReport& report, const ConvertOptions& options) {
  std::printf("%s\n", options.output.c_str());
  printTopics(report);
  if (report.scans == 0) {
    row("packets accepted", report.packets.accepted);
    for (int fault = 1; fault < kNumPacketFaults; ++fault) {
      const int64_t count = report.packets.rejected[static_cast<size_t>(fault)];
      const std::string name = std::string("refused: ") + toString(static_cast<PacketFault>(fault));
      if (count > 0) row(name.c_str(), count);
    }
    if (report.packets.other_sensor > 0) row("refused: second sensor", report.packets.other_sensor);
    row("packets lost", report.packets.lost, "  (by the sensor's stamps)");
    if (!options.pcap.empty()) row("position packets", report.packets.position);
    row("full revolutions", report.revolutions);
  } else {
    row("scans", report.scans);
  }
  std::printf("  %-32s %10.3f s\n", "duration", (report.end - report.begin).seconds());
  row("odometry samples", report.odometry);
  row("events written", report.events);
}

void runConvertCommand(ConvertArguments& arguments) {
  ConvertOptions& options = arguments.options;
  const bool is_bag = !options.bag.empty() || !options.db3.empty();
  const int inputs = !options.pcap.empty() + !options.raw.empty() + !options.scans.empty() +
                     !options.bag.empty() + !options.db3.empty();
  if (inputs != 1) throw UsageError("give exactly one of --pcap, --raw, --scans, --bag and --db3");
  if (!is_bag && !(options.topics.lidar.empty() && options.topics.odometry.empty()))
    throw UsageError("--lidar-topic and --odometry-topic go with --bag or --db3");
  if (!options.topics.odometry.empty() && options.topics.odometry != "none" && !options.odometry_tum.empty())
    throw UsageError("give --odometry-topic or --odometry-tum, not both");
  if (!options.raw.empty() && arguments.start_utime <= 0)
    throw UsageError("--raw needs --start-utime: the time of its first firing [us since the Unix epoch]");
  options.raw_start = Time{arguments.start_utime};
  if (!arguments.T_body_lidar.empty())
    options.T_body_lidar = parseTransform(arguments.T_body_lidar, "--T-body-lidar");
  if (!options.odometry_mode.empty()) parseOdometryMode(options.odometry_mode);
  ConvertReport report;
  {
    ProgressLine line;
    report = convertRecording(options, [&](double share) { line.update(share); });
  }
  if (arguments.T_body_lidar.empty())
    report.warnings.push_back(
        "no --T-body-lidar: the LiDAR counts as mounted at the body's origin, x forward, z up");
  for (const std::string& warning : report.warnings) spdlog::warn(warning);
  printReport(report, options);
}

}  // namespace

void addConvert(CLI::App& app) {
  auto arguments = std::make_shared<ConvertArguments>();
  ConvertOptions& options = arguments->options;
  CLI::App* command = app.add_subcommand("convert", "Turn another recording into an LCM log");
  command->add_option("--pcap", options.pcap, "VLP-16 capture (pcap or pcapng)");
  command->add_option("--port", options.data_port, "UDP port of the data packets")->capture_default_str();
  command->add_option("--raw", options.raw, "VLP-16 packets of 1206 bytes back to back");
  command->add_option("--start-utime", arguments->start_utime,
                      "With --raw: first firing of the first packet [us since the Unix epoch]");
  command->add_option(
      "--scans", options.scans,
      "Folder of .pcd, .ply or KITTI .bin scans in the lidar frame, with times.txt (one time [s] "
      "per file, in order of names)");
  command->add_option("--bag", options.bag, "ROS 1 bag with VelodyneScan or PointCloud2, and Odometry");
  command->add_option("--db3", options.db3, "The same of ROS 2: a .db3 file, or the folder of one recording");
  command->add_option("--lidar-topic", options.topics.lidar,
                      "Topic of a bag with the LiDAR; needed only where there are several");
  command->add_option("--odometry-topic", options.topics.odometry,
                      "Topic of a bag with the odometry, or none; needed only where there are several");
  command->add_option("--odometry-tum", options.odometry_tum,
                      "Body in its odometry frame, rows 't x y z qx qy qz qw', in the LiDAR's clock");
  command->add_option("--T-body-lidar", arguments->T_body_lidar,
                      "LiDAR's mount on the body, \"x y z qx qy qz qw\"");
  command->add_option("--odometry", options.odometry_mode,
                      "Odometry mode to write into the log: lidar, encoder or fused (default: left open)");
  command->add_option("-o,--output", options.output, "LCM log to write")->required();
  command->footer(
      "Example:\n  sgraphs convert --pcap lidar.pcap --odometry-tum odom.tum "
      "--T-body-lidar \"0.12 0 0.31 0 0 0 1\" -o run.lcmlog\n"
      "  sgraphs convert --bag walk.bag --lidar-topic /velodyne_packets "
      "--T-body-lidar \"0.12 0 0.31 0 0 0 1\" -o run.lcmlog");
  command->callback([arguments] { runConvertCommand(*arguments); });
}

}  // namespace sgraphs::cli
