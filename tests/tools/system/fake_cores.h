#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "backend/backend_node.h"
#include "common/base/sha256.h"
#include "perception/odometry/odometry_node.h"

// Small cores in place of the real ones: quick, and every input shows in their output.
namespace sgraphs::testing {

// Stages of a session.
inline const std::vector<std::string> kWithoutLoops = {"odometry", "free-space", "rooms", "backend"};

// 10 cm forward per scan; every `keyframe_every`-th scan is a keyframe of `points` points. A scan without
// points cannot be used. The covariance holds what the step was given, so that ODOMETRY shows it.
class FakeOdometry {
 public:
  explicit FakeOdometry(int keyframe_every = 3, size_t points = 20)
      : keyframe_every_(keyframe_every), points_(points) {}

  std::optional<OdometryEstimate> step(const LidarScan& scan, std::span<const BodyOdometry> samples) {
    if (scan.points.empty()) return std::nullopt;
    OdometryEstimate& e = last_ = {};
    e.time = scan.end;
    e.scan = scan_++;
    e.T_odom_body.translation.x() = 0.1 * static_cast<double>(e.scan);
    e.covariance = Matrix6d::Identity() * (1.0 + static_cast<double>(samples.size()));
    e.extrapolated = !samples.empty() && samples.back().time < scan.end;
    e.is_keyframe = e.scan % keyframe_every_ == 0;
    e.keyframe = KeyframeId{e.scan / keyframe_every_};
    return e;
  }

  std::optional<Keyframe> takeKeyframe() const {
    const OdometryEstimate& e = last_;
    if (!e.is_keyframe) return std::nullopt;
    Keyframe k;
    k.id = e.keyframe;
    k.time = e.time;
    k.scan = e.scan;
    k.T_odom_body = e.T_odom_body;
    k.T_keyframe_body = {SE3()};
    for (size_t i = 0; i < points_; ++i) {
      const auto x = static_cast<float>(i % 100);
      k.points.push_back({{0.1f * x, 1.0f, 0.5f}, 0, 1});
    }
    if (k.id.value > 0) {
      const SE3 T(Eigen::Quaterniond::Identity(), {0.1 * keyframe_every_, 0, 0});
      k.relative_poses.push_back(
          {RelativePoseKind::kOdometry, KeyframeId{k.id.value - 1}, k.id, T, Matrix6d::Identity()});
    }
    return k;
  }

 private:
  int keyframe_every_;
  size_t points_;
  int64_t scan_ = 0;
  OdometryEstimate last_;
};

// Keyframes stay where odometry put them, 1 m higher; the digest covers every input so far. An idle round
// changes something `busy_rounds` times.
class FakeBackend {
 public:
  explicit FakeBackend(int busy_rounds = 0) : busy_rounds_(busy_rounds) {}

  RoundOutput step(const RoundInput& input) {
    RoundOutput out;
    Sha256 sha;
    sha.add(digest_);
    sha.add(input.round);
    sha.add(input.time.us);
    if (input.keyframe) {
      addKeyframe(*input.keyframe);
      out.changed = {input.keyframe->id};
      sha.add(input.keyframe->id.value);
      sha.add(static_cast<int64_t>(input.keyframe->points.size()));
      for (const RelativePose& r : input.keyframe->relative_poses) sha.add(r.covariance);
    } else {
      ++idle_rounds;
      if (busy_rounds_-- > 0) out.changed = {graph.keyframes.begin()->first};
    }
    if (digest_of) sha.add(digest_of(input));
    inputs.push_back(input);
    digest_ = out.graph_digest = sha.hex();
    out.T_map_odom.translation.z() = 1.0 + static_cast<double>(input.round);
    return out;
  }

  SituationalGraph graph;
  std::vector<RoundInput> inputs;
  int idle_rounds = 0;
  std::function<std::string(const RoundInput&)> digest_of = {};  // what else of an input the digest shows

 private:
  void addKeyframe(const Keyframe& keyframe) {
    KeyframeNode node;
    node.id = keyframe.id;
    node.time = keyframe.time;
    node.T_odom_body = node.T_map_body = keyframe.T_odom_body;
    node.T_map_body.translation.z() += 1.0;
    node.keyframe = std::make_shared<Keyframe>(keyframe);
    graph.keyframes[keyframe.id] = node;
  }

  int busy_rounds_;
  std::string digest_;
};

inline OdometryParts partsOf(const std::shared_ptr<FakeOdometry>& fake) {
  OdometryParts parts;
  // One packet is one scan of 0.1 s: these tests are not about decoding.
  parts.make_decoder = [] {
    return [](const VelodynePacket& packet) -> std::optional<LidarScan> {
      LidarScan scan;
      scan.begin = packet.time;
      scan.end = packet.time + Duration{100'000};
      scan.points.resize(1);
      return scan;
    };
  };
  parts.make_step = [fake](OdometryMode, const SE3&) {
    return OdometryParts::Step{[fake](const LidarScan& scan, std::span<const BodyOdometry> samples) {
                                 return fake->step(scan, samples);
                               },
                               [fake] { return fake->takeKeyframe(); }};
  };
  return parts;
}

inline BackendCore coreOf(const std::shared_ptr<FakeBackend>& fake) {
  return {[fake](const RoundInput& input) { return fake->step(input); },
          [fake]() -> const SituationalGraph& { return fake->graph; },
          [] { return std::map<std::string, FactorStatistics>{}; }};
}

}  // namespace sgraphs::testing
