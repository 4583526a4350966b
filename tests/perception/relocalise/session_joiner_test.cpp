#include "perception/relocalise/session_joiner.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/bus/channels.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs {
namespace {

constexpr int64_t kMapSession = 77, kOwnSession = 4711;

SE3 poseAt(double x, double y, double heading_rad) {
  return {so3Exp({0, 0, heading_rad}), {x, y, 0}};
}

bool near(const SE3& a, const SE3& b) {
  return se3Log(a.inverse() * b).norm() < 1e-9;
}

// A map that ends with keyframe 41 and scan 399, and a session whose clock and odom are its own.
class SessionJoinerTest : public ::testing::Test {
 protected:
  SessionJoinerTest() {
    map_.session = kMapSession;
    map_.boot = 2;
    map_.last_seq = {{channels::kOdometry.name, 399},
                     {channels::kKeyframe.name, 120},
                     {channels::kKeyframePlanes.name, 41}};
    map_.keyframe = KeyframeId{41};
    map_.scan = 399;
    map_.time = Time{50'000'000};
    map_.T_map_odom = poseAt(1, 2, 0.3);
    start_.anchor = KeyframeId{7};
    start_.T_anchor_first = poseAt(0.4, -0.2, 2.4);
    start_.covariance = 1e-4 * Matrix6d::Identity();
    start_.T_map_odom = poseAt(-5, 3, 2.0);
  }

  SessionJoiner make() {
    return SessionJoiner(map_, {[this](const odometry_t& m) { odometry_.push_back(m); },
                                [this](const keyframe_t& m) {
                                  keyframes_.push_back(m);
                                  order_ += 'k';
                                },
                                [this](const keyframe_planes_t& m) {
                                  planes_.push_back(m);
                                  order_ += 'p';
                                },
                                [this](const stream_end_t& m) { ends_.push_back(m); },
                                [this](const stream_end_t& m) { ends_.push_back(m); }});
  }
  // Scan, and keyframe if it became one, at 10 Hz from `begin_us` on.
  odometry_t odometryOf(int64_t scan, int64_t keyframe, int64_t begin_us) const {
    OdometryEstimate e;
    e.time = Time{begin_us + 100'000 * scan};
    e.scan = scan;
    e.T_odom_body = poseAt(0.1 * static_cast<double>(scan), 0, 0);
    e.keyframe = KeyframeId{keyframe};
    odometry_t m = toMessage(e);
    m.header.session = kOwnSession;
    m.header.seq = scan;
    return m;
  }
  keyframe_t keyframeOf(int64_t id, int64_t scan, int64_t begin_us) const {
    Keyframe k;
    k.id = KeyframeId{id};
    k.time = Time{begin_us + 100'000 * scan};
    k.scan = scan;
    k.T_odom_body = poseAt(0.1 * static_cast<double>(scan), 0, 0);
    k.T_keyframe_body = {SE3()};
    if (id > 0) {
      RelativePose z;
      z.from = KeyframeId{id - 1};
      z.to = k.id;
      k.relative_poses = {z};
    }
    keyframe_t m = toMessages(k).front();
    m.header.session = kOwnSession;
    m.header.seq = id;
    return m;
  }
  keyframe_planes_t planesOf(int64_t id, int64_t begin_us) const {
    keyframe_planes_t m = toMessage(KeyframePlanes{KeyframeId{id}, Time{begin_us}, {}});
    m.header.session = kOwnSession;
    m.header.seq = id;
    return m;
  }
  void speak(SessionJoiner& dut, int64_t begin_us) const {
    dut.add(keyframeOf(0, 0, begin_us));
    dut.add(odometryOf(0, 0, begin_us));
    dut.add(planesOf(0, begin_us));
    dut.add(keyframeOf(1, 9, begin_us));
    dut.add(odometryOf(9, 1, begin_us));
  }

  MapEnd map_;
  SessionStart start_;
  std::vector<odometry_t> odometry_;
  std::vector<keyframe_t> keyframes_;
  std::vector<keyframe_planes_t> planes_;
  std::vector<stream_end_t> ends_;
  std::string order_;
};

TEST_F(SessionJoinerTest, NothingIsSaidUntilTheRobotIsFoundAndThenAllInOrder) {
  SessionJoiner dut = make();
  speak(dut, 60'000'000);
  EXPECT_TRUE(keyframes_.empty() && odometry_.empty() && planes_.empty());
  EXPECT_GT(dut.heldBytes(), 500u);
  dut.join(start_);
  EXPECT_EQ(dut.heldBytes(), 0u);
  EXPECT_EQ(order_, "kpk");
  EXPECT_EQ(odometry_.size(), 2u);
  dut.add(planesOf(1, 60'000'000));
  EXPECT_EQ(order_, "kpkp");
}

TEST_F(SessionJoinerTest, IdsNumbersAndSessionGoOnAfterTheMap) {
  SessionJoiner dut = make();
  speak(dut, 60'000'000);
  dut.join(start_);
  EXPECT_EQ(keyframes_[0].keyframe, 42);
  EXPECT_EQ(keyframes_[1].keyframe, 43);
  EXPECT_EQ(keyframes_[1].scan, 409);
  EXPECT_EQ(keyframes_[0].header.seq, 121);
  EXPECT_EQ(keyframes_[0].header.session, kMapSession);
  EXPECT_EQ(keyframes_[0].header.boot, 2);
  EXPECT_EQ(odometry_[0].scan, 400);
  EXPECT_EQ(odometry_[1].keyframe, 43);
  EXPECT_EQ(odometry_[0].header.seq, 400);
  EXPECT_EQ(planes_[0].keyframe, 42);
  EXPECT_EQ(planes_[0].header.seq, 42);
  ASSERT_EQ(keyframes_[1].num_relative_poses, 1);
  EXPECT_EQ(keyframes_[1].relative_poses[0].from_keyframe, 42);
  EXPECT_EQ(keyframes_[1].relative_poses[0].to_keyframe, 43);
}

TEST_F(SessionJoinerTest, TheFirstKeyframeIsMeasuredFromTheMap) {
  SessionJoiner dut = make();
  speak(dut, 60'000'000);
  dut.join(start_);
  ASSERT_EQ(keyframes_[0].num_relative_poses, 1);
  const auto z = fromMessage(keyframes_[0].relative_poses[0]);
  ASSERT_TRUE(z);
  EXPECT_EQ(z->kind, RelativePoseKind::kNeighbour);
  EXPECT_EQ(z->from, KeyframeId{7});
  EXPECT_EQ(z->to, KeyframeId{42});
  EXPECT_TRUE(near(z->T_from_to, start_.T_anchor_first));
  EXPECT_EQ(z->covariance, start_.covariance);
  EXPECT_FALSE(z->registered);
}

// Whoever compares poses in odom of the two sessions sees where the robot was carried to, in the map.
TEST_F(SessionJoinerTest, PosesGoOnInTheMapsOdom) {
  SessionJoiner dut = make();
  speak(dut, 60'000'000);
  dut.join(start_);
  for (const auto& [told, own] : {std::pair(keyframes_[1].T_odom_body, poseAt(0.9, 0, 0)),
                                  std::pair(odometry_[0].T_odom_body, SE3())}) {
    const auto T_mapodom_body = fromMessage(told);
    ASSERT_TRUE(T_mapodom_body);
    EXPECT_TRUE(near(map_.T_map_odom * *T_mapodom_body, start_.T_map_odom * own));
    EXPECT_TRUE(near(*T_mapodom_body, dut.T_mapodom_odom() * own));
  }
}

TEST_F(SessionJoinerTest, ClocksBeforeBesideAndBehindTheMapsOneAllGoOn) {
  for (const int64_t begin_us : {1'000'000LL, 49'900'000LL, 50'000'000LL, 900'000'000LL}) {
    odometry_.clear();
    keyframes_.clear();
    SessionJoiner dut = make();
    speak(dut, begin_us);
    dut.join(start_);
    EXPECT_GT(odometry_[0].header.utime, map_.time.us) << begin_us;
    EXPECT_EQ(odometry_[0].header.utime, keyframes_[0].header.utime);
    EXPECT_EQ(odometry_[1].header.utime - odometry_[0].header.utime, 900'000);
    EXPECT_EQ(odometry_[0].header.utime - dut.shift().us, begin_us);
    EXPECT_GE(dut.shift().us, 0) << "a clock that is behind the map's is left as it is";
  }
}

TEST_F(SessionJoinerTest, EndsNameTheContinuedNumbers) {
  SessionJoiner dut = make();
  speak(dut, 60'000'000);
  dut.join(start_);
  stream_end_t end{};
  end.header.session = kOwnSession;
  end.num_channels = 2;
  end.channel = {channels::kOdometry.name, channels::kKeyframe.name};
  end.last_seq = {1, 1};
  dut.addOdometryEnd(end);
  ASSERT_EQ(ends_.size(), 1u);
  EXPECT_EQ(ends_[0].header.session, kMapSession);
  EXPECT_EQ(ends_[0].last_seq, (std::vector<int64_t>{401, 122}));
}

TEST_F(SessionJoinerTest, WhatWaitsCanBeDropped) {
  SessionJoiner dut = make();
  speak(dut, 60'000'000);
  dut.drop();
  EXPECT_EQ(dut.heldBytes(), 0u);
  EXPECT_FALSE(dut.joined());
}

}  // namespace
}  // namespace sgraphs
