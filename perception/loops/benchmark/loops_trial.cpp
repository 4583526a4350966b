// Runs the search for loops on a recording of all channels (sgraphs replay --record) and judges every loop by
// the truth. With --scale and --yaw the map's poses drift as a robot's do whose odometry is bad; accepted
// loops then bend the path between their ends, as a graph would.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "common/bus/channels.h"
#include "common/bus/log_file.h"
#include "common/io/tum.h"
#include "lcmtypes/convert/chunks.h"
#include "lcmtypes/convert/convert_layers.h"
#include "lcmtypes/convert/keyframe_assembly.h"
#include "perception/loops/loop_finder.h"
#include "perception/loops/loop_search.h"

namespace sgraphs {
namespace {

struct Round {
  std::optional<Keyframe> keyframe;
  MapUpdate update;
};

template <typename Message>
std::optional<Message> decoded(const LogEvent& event) {
  Message m;
  if (m.decode(event.bytes.data(), 0, static_cast<int>(event.bytes.size())) < 0) return std::nullopt;
  return m;
}

std::vector<Round> readRounds(const std::string& path) {
  LogReader reader(path);
  KeyframeAssembly keyframes;
  RoundAssembly<graph_update_t> updates;
  std::vector<MapUpdate> all;
  std::map<KeyframeId, Keyframe> clouds;
  std::set<int64_t> complete;
  std::vector<Round> rounds;
  while (const std::optional<LogEvent> event = reader.next()) {
    if (event->channel == channels::kKeyframe.name) {
      const auto m = decoded<keyframe_t>(*event);
      if (m && keyframes.add(*m) == KeyframeAssembly::Fate::kComplete)
        if (auto k = keyframes.take(m->keyframe)) clouds.emplace(k->id, std::move(*k));
    } else if (event->channel == channels::kGraphUpdate.name) {
      const auto m = decoded<graph_update_t>(*event);
      bool refused = false;
      if (!m) continue;
      if (const auto chunks = updates.add(*m, refused))
        if (auto update = fromMessages(*chunks)) all.push_back(std::move(*update));
    }
  }
  for (MapUpdate& update : all) {
    Round round;
    const auto it = clouds.find(update.newest);
    if (!update.idle && it != clouds.end()) {
      round.keyframe = std::move(it->second);
      clouds.erase(it);
    }
    round.update = std::move(update);
    rounds.push_back(std::move(round));
  }
  return rounds;
}

struct Drift {
  double scale = 0;
  double yaw_rad_per_m = 0;
  bool any() const { return scale != 0 || yaw_rad_per_m != 0; }
};

// A map that goes wrong as the odometry does, and is bent by loops.
class DriftingMap {
 public:
  explicit DriftingMap(const Drift& drift) : drift_(drift) {}

  void step(Round& round) {
    if (!drift_.any()) return;
    std::vector<MapKeyframe> changed;
    for (const MapKeyframe& k : round.update.keyframes) {
      if (poses_.contains(k.id)) continue;
      MapKeyframe drifted = k;
      if (!poses_.empty()) {
        SE3 step = last_.inverse() * k.T_map_body;
        const double m = step.translation.norm();
        step = SE3(step.rotation * so3Exp({0, 0, drift_.yaw_rad_per_m * m}),
                   (1.0 + drift_.scale) * step.translation);
        drifted.T_map_body = poses_.rbegin()->second.T_map_body * step;
        odometry_ = odometry_ * step;
      }
      last_ = k.T_map_body;
      poses_[k.id] = drifted;
      dirty_ = true;
      if (round.keyframe && round.keyframe->id == k.id) {
        round.keyframe->T_odom_body = odometry_;
        for (RelativePose& r : round.keyframe->relative_poses) r.registered = false;
      }
    }
    round.update.keyframes.clear();
    for (const auto& [id, k] : poses_) round.update.keyframes.push_back(k);
  }

  void close(const LoopClosure& loop) {
    if (!drift_.any()) return;
    const SE3 target = poses_.at(loop.pose.from).T_map_body * loop.pose.T_from_to;
    const SE3 correction = target * poses_.at(loop.pose.to).T_map_body.inverse();
    const double span = static_cast<double>(loop.pose.to.value - loop.pose.from.value);
    for (auto& [id, k] : poses_) {
      const double share = std::clamp(static_cast<double>(id.value - loop.pose.from.value) / span, 0.0, 1.0);
      k.T_map_body = interpolate(SE3(), correction, share) * k.T_map_body;
    }
  }

 private:
  Drift drift_;
  SE3 last_, odometry_;
  std::map<KeyframeId, MapKeyframe> poses_;
  bool dirty_ = false;
};

SE3 truthAt(const std::vector<StampedPose>& truth, Time t) {
  auto it = std::lower_bound(truth.begin(), truth.end(), t,
                             [](const StampedPose& p, Time x) { return p.time < x; });
  if (it == truth.begin()) return it->pose;
  if (it == truth.end()) return truth.back().pose;
  const auto before = it - 1;
  const double s =
      static_cast<double>((t - before->time).us) / static_cast<double>((it->time - before->time).us);
  return interpolate(before->pose, it->pose, s);
}

int run(const std::string& log, const std::string& truth_dir, const Drift& drift, const LoopsConfig& config,
        bool verbose) {
  std::vector<Round> rounds = readRounds(log);
  const std::vector<StampedPose> truth = readTum(truth_dir + "/gt.tum");
  LoopFinder finder(config);
  DriftingMap map(drift);
  std::map<KeyframeId, Time> times;
  std::map<KeyframeId, SE3> poses;
  std::vector<double> ms;
  int accepted = 0, wrong = 0, withdrawn = 0;
  double nees_t = 0, nees_r = 0, worst_m = 0;
  std::vector<double> errors_m;
  PlaceMemory memory(config.place_spacing_m, 10);
  for (Round& round : rounds) {
    map.step(round);
    for (const MapKeyframe& k : round.update.keyframes) {
      times[k.id] = k.time;
      poses[k.id] = k.T_map_body;
    }
    const auto begin = std::chrono::steady_clock::now();
    const LoopClosures loops = finder.step(round.keyframe, round.update);
    ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    withdrawn += static_cast<int>(loops.withdrawn.size());
    for (const LoopId id : loops.withdrawn) std::printf("withdrawn %s\n", id.str().c_str());
    for (const LoopClosure& loop : loops.accepted) {
      const SE3 T_true =
          truthAt(truth, times[loop.pose.from]).inverse() * truthAt(truth, times[loop.pose.to]);
      const SE3 T_map = poses[loop.pose.from].inverse() * poses[loop.pose.to];
      const Vector6d e = se3Log(T_true.inverse() * loop.pose.T_from_to);
      const double m = e.head<3>().norm(), rad = e.tail<3>().norm();
      const Matrix6d& C = loop.pose.covariance;
      const double t = e.head<3>().dot(C.topLeftCorner<3, 3>().inverse() * e.head<3>());
      const double r = e.tail<3>().dot(C.bottomRightCorner<3, 3>().inverse() * e.tail<3>());
      ++accepted;
      wrong += m > 0.3 || rad > 0.0873;
      worst_m = std::max(worst_m, m);
      errors_m.push_back(m);
      nees_t += t;
      nees_r += r;
      if (verbose || m > 0.3 || rad > 0.0873)
        std::printf(
            "%s %s->%s drift %.3f m, error %.4f m %.3f deg, nees %.2f %.2f, overlap %.2f inliers %.3f%s\n",
            loop.id.str().c_str(), loop.pose.from.str().c_str(), loop.pose.to.str().c_str(),
            (T_true.translation - T_map.translation).norm(), m, rad * 57.2958, t, r, loop.overlap,
            loop.inlier_share, m > 0.3 || rad > 0.0873 ? " FALSE" : "");
      map.close(loop);
    }
  }
  std::sort(ms.begin(), ms.end());
  std::sort(errors_m.begin(), errors_m.end());
  double sum = 0;
  for (const double x : ms) sum += x;
  const double n = std::max(1, accepted);
  std::printf(
      "%s: %d accepted, %d false, %d withdrawn; error median %.4f max %.4f m; NEES %.2f %.2f; round p50 %.1f "
      "p99 %.1f max %.1f mean %.1f ms; %zu rounds\n",
      log.c_str(), accepted, wrong, withdrawn, errors_m.empty() ? 0.0 : errors_m[errors_m.size() / 2],
      worst_m, nees_t / n, nees_r / n, ms[ms.size() / 2], ms[ms.size() * 99 / 100], ms.back(),
      sum / static_cast<double>(ms.size()), ms.size());
  return wrong > 0;
}

}  // namespace
}  // namespace sgraphs

int main(int argc, char** argv) {
  using namespace sgraphs;
  CLI::App app("Loops of a recording of all channels, judged by the truth");
  std::string log, truth;
  Drift drift;
  LoopsConfig config;
  std::vector<std::string> settings;
  bool verbose = false;
  app.add_option("log", log, "Recording with KEYFRAME and GRAPH_UPDATE")->required();
  app.add_option("--truth", truth, "Folder with gt.tum")->required();
  app.add_option("--scale", drift.scale, "Error of distances, as a share");
  app.add_option("--yaw", drift.yaw_rad_per_m, "Drift of the heading [rad/m]");
  app.add_option("--set", settings, "key=value of the loops' configuration");
  app.add_flag("-v", verbose, "Every loop");
  CLI11_PARSE(app, argc, argv);
  for (const std::string& s : settings) setConfigValue(visitOf(config), s);
  return run(log, truth, drift, config, verbose);
}
