#include "drivers/recording/convert_recording.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <sstream>

#include "common/base/error.h"
#include "common/base/sha256.h"
#include "common/io/tum.h"
#include "drivers/recording/recording_writer.h"
#include "drivers/recording/ros/ros_recording.h"
#include "drivers/recording/scan_folder.h"

namespace sgraphs {
namespace {

constexpr int64_t kItemsPerProgress = 1000;
// Odometry this far outside the LiDAR's time is left out.
constexpr Duration kOdometryMargin{10'000'000};

// One LiDAR item in order of time: a packet or a scan.
struct LidarItem {
  std::optional<VelodynePacket> packet;
  std::optional<LidarScan> scan;
  Time time() const { return packet ? packet->time : scan->end; }
};

const std::string& bagPath(const ConvertOptions& options) {
  return options.bag.empty() ? options.db3 : options.bag;
}

std::unique_ptr<RosBag> openBagFile(const ConvertOptions& options) {
  return options.bag.empty() ? openRos2Bag(options.db3) : openRos1Bag(options.bag);
}

// The LiDAR's side of the conversion, whichever input it is.
class LidarInput {
 public:
  explicit LidarInput(const ConvertOptions& options) {
    if (!options.pcap.empty())
      packets_ = std::make_unique<PcapPacketSource>(options.pcap, options.data_port);
    else if (!options.raw.empty())
      packets_ = std::make_unique<RawPacketSource>(options.raw, options.raw_start);
    else if (!options.scans.empty())
      sweeps_ = std::make_unique<ScanFolder>(options.scans);
    else
      openBag(options);
  }
  std::optional<LidarItem> next() {
    LidarItem item;
    if (packets_)
      item.packet = packets_->next();
    else
      item.scan = sweeps_->next();
    return item.packet || item.scan ? std::optional(std::move(item)) : std::nullopt;
  }
  double progress() const { return packets_ ? packets_->progress() : sweeps_->progress(); }
  std::string whyNothing() const { return packets_ ? packets_->whyNothing() : sweeps_->whyNothing(); }
  const PacketSource* packets() const { return packets_.get(); }
  // What the end of the LiDAR's data has to say, and what a bag says of itself.
  void report(ConvertReport& report) const {
    if (packets_) report.packets = packets_->counts();
    if (bag_) report.topics = bag_->topics();
    report.body_frame = odometry_.body_frame;
    report.warnings = packets_ ? packets_->warnings() : sweeps_->warnings();
    for (const std::string& line : odometry_.warnings) report.warnings.push_back(line);
  }
  // That a bag holds; empty without one.
  const std::vector<BodyOdometry>& odometry() const { return odometry_.samples; }
  std::string odometryName() const { return bag_->topics().odometry.name; }

 private:
  void openBag(const ConvertOptions& options) {
    WantedTopics wanted = options.topics;
    if (!options.odometry_tum.empty()) wanted.odometry = "none";
    bag_ = std::make_unique<RosRecording>(bagPath(options), openBagFile(options), wanted);
    odometry_ = bag_->readOdometry();
    packets_ = bag_->packets();
    sweeps_ = bag_->sweeps();
  }

  std::unique_ptr<RosRecording> bag_;  // outlives the two that look into it
  RosOdometryTopic odometry_;
  std::unique_ptr<PacketSource> packets_;
  std::unique_ptr<SweepSource> sweeps_;
};

// Identity of the recording: of its content, not of when or where it was converted.
int64_t sessionId(const ConvertOptions& options) {
  Sha256 sha;
  for (const std::string& file : {options.pcap, options.raw, options.odometry_tum})
    sha.add(std::string_view(file.empty() ? "" : sha256OfFile(file)));
  if (!options.scans.empty()) {
    const ScanFolder folder(options.scans);
    sha.add(std::string_view(sha256OfFile(folder.timesFile())));
    for (const std::string& file : folder.files()) sha.add(std::string_view(sha256OfFile(file)));
  }
  if (!bagPath(options).empty()) {
    for (const std::string& file : openBagFile(options)->files())
      sha.add(std::string_view(sha256OfFile(file)));
    sha.add(std::string_view(options.topics.lidar));
    sha.add(std::string_view(options.topics.odometry));
  }
  sha.add(options.raw_start.us);
  sha.add(int64_t{options.data_port});
  sha.add(options.T_body_lidar.translation);
  sha.add(options.T_body_lidar.rotation.coeffs());
  sha.add(std::string_view(options.odometry_mode));
  const auto id = static_cast<int64_t>(std::stoull(sha.hex().substr(0, 16), nullptr, 16) >> 1);
  return id == 0 ? 1 : id;
}

// The log under a temporary name, which becomes the output's only if all went well.
class PendingLog {
 public:
  explicit PendingLog(const std::string& path) : path_(path), part_(path + ".part"), log_(part_) {}
  ~PendingLog() {
    std::error_code ignored;
    if (!done_) std::filesystem::remove(part_, ignored);
  }
  LogWriter& log() { return log_; }
  void commit() {
    log_.close();
    std::error_code error;
    std::filesystem::rename(part_, path_, error);
    if (error) throw Error("cannot write log '" + path_ + "': " + error.message());
    done_ = true;
  }

 private:
  std::string path_, part_;
  LogWriter log_;
  bool done_ = false;
};

std::vector<BodyOdometry> readOdometry(const std::string& path) {
  std::vector<BodyOdometry> samples;
  if (path.empty()) return samples;
  for (const StampedPose& row : readTum(path)) {
    // The header's time must tell samples apart.
    if (samples.empty() || row.time > samples.back().time) samples.push_back({row.time, row.pose});
  }
  return samples;
}

std::string secondsOf(Time time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", static_cast<double>(time.us) * 1e-6);
  return text;
}

void requireCommonTime(Time lidar_begin, Time lidar_end, const std::vector<BodyOdometry>& odometry,
                       const std::string& path) {
  if (odometry.empty()) return;
  const Time begin = odometry.front().time, end = odometry.back().time;
  if (begin <= lidar_end && end >= lidar_begin) return;
  throw Error("'" + path + "' and the LiDAR share no time (odometry " + secondsOf(begin) + " to " +
              secondsOf(end) + " s, LiDAR from " + secondsOf(lidar_begin) +
              " s): both must be in the same clock");
}

// Feeds everything to the writer in order of time.
void merge(LidarInput& lidar, LidarItem first, const std::vector<BodyOdometry>& odometry,
           RecordingWriter& writer, ConvertReport& report, const Progress& progress) {
  RevolutionCutter cutter;
  int64_t cuts = 0, items = 0;
  auto sample = odometry.begin();
  report.begin = report.end = first.time();
  for (std::optional<LidarItem> item = std::move(first); item; item = lidar.next()) {
    for (; sample != odometry.end() && sample->time < item->time(); ++sample) writer.addOdometry(*sample);
    report.end = std::max(report.end, item->time());
    if (item->packet) {
      writer.addPacket(*item->packet);
      cuts += cutter.step(item->packet->bytes) >= 0;
    } else {
      writer.addScan(*item->scan);
      ++report.scans;
    }
    if (++items % kItemsPerProgress == 0 || item->scan) progress(lidar.progress());
  }
  for (; sample != odometry.end() && sample->time < report.end + kOdometryMargin; ++sample)
    writer.addOdometry(*sample);
  writer.finish();
  report.odometry = sample - odometry.begin();
  report.revolutions = std::max<int64_t>(0, cuts - 1);
}

}  // namespace

ConvertReport convertRecording(const ConvertOptions& options, const Progress& progress) {
  LidarInput lidar(options);
  std::vector<BodyOdometry> odometry =
      lidar.odometry().empty() ? readOdometry(options.odometry_tum) : lidar.odometry();
  const std::string odometry_name = lidar.odometry().empty() ? options.odometry_tum : lidar.odometryName();
  const auto num_samples = static_cast<int64_t>(odometry.size());
  std::optional<LidarItem> first = lidar.next();
  if (!first) throw Error(lidar.whyNothing());
  constexpr Time kAnyTime{std::numeric_limits<int64_t>::max()};
  requireCommonTime(first->time(), kAnyTime, odometry, odometry_name);
  std::erase_if(odometry,
                [&](const BodyOdometry& sample) { return sample.time < first->time() - kOdometryMargin; });

  ConvertReport report;
  Session session;
  session.id = report.session = sessionId(options);
  session.start = odometry.empty() ? first->time() : std::min(first->time(), odometry.front().time);
  session.writer = "sgraphs convert " SGRAPHS_VERSION;
  session.odometry_mode = options.odometry_mode;
  session.has_odometry = !odometry.empty();
  session.T_body_lidar = options.T_body_lidar;

  PendingLog output(options.output);
  RecordingWriter writer(output.log(), session);
  merge(lidar, std::move(*first), odometry, writer, report, progress);
  requireCommonTime(report.begin, report.end, odometry, odometry_name);
  report.events = output.log().events();
  lidar.report(report);
  if (lidar.packets() && report.revolutions == 0)
    report.warnings.push_back("the recording holds no complete revolution");
  if (report.odometry < num_samples)
    report.warnings.push_back(odometry_name + ": " + std::to_string(num_samples - report.odometry) +
                              " sample(s) far outside the LiDAR's time left out");
  output.commit();
  return report;
}

SE3 parseTransform(const std::string& text, const std::string& option) {
  std::string blanks = text;
  std::replace(blanks.begin(), blanks.end(), ',', ' ');
  std::istringstream in(blanks);
  double v[7];
  for (double& value : v) in >> value;
  std::string rest;
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!in || in >> rest)
    throw UsageError(option + " '" + text + "': give seven numbers \"x y z qx qy qz qw\"");
  SE3 T(q.normalized(), {v[0], v[1], v[2]});
  if (!T.isFinite() || std::abs(q.norm() - 1.0) > 1e-3)
    throw UsageError(option + " '" + text + "': qx qy qz qw must be a unit quaternion");
  return T;
}

}  // namespace sgraphs
