#include "lcmtypes/convert/convert.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/lcmtypes/through_bytes.h"

namespace sgraphs {
namespace {

using test::kNaN;
using test::throughBytes;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

SE3 someTransform() {
  Vector6d xi;
  xi << 1.5, -2.25, 0.125, 0.4, -0.9, 2.0;
  return se3Exp(xi);
}

void expectSame(const SE3& a, const SE3& b) {
  EXPECT_EQ(a.translation, b.translation);
  EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
}

Matrix6d someCovariance() {
  Matrix6d a;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) a(r, c) = 0.01 * (r == c) + 0.001 * ((3 * r + 5 * c) % 7);
  return a * a.transpose();
}

TEST(ConvertTransformTest, RoundTripIsExact) {
  expectSame(*fromMessage(throughBytes(toMessage(someTransform()))), someTransform());
  expectSame(*fromMessage(throughBytes(toMessage(SE3()))), SE3());
}

TEST(ConvertTransformTest, WhatIsNoTransformIsRefused) {
  for (int i = 0; i < 3; ++i) {
    transform_t m = toMessage(someTransform());
    m.xyz[i] = i == 0 ? kNaN : kInfinity;
    EXPECT_FALSE(fromMessage(m));
  }
  for (int i = 0; i < 4; ++i) {
    transform_t m = toMessage(someTransform());
    m.wxyz[i] = kNaN;
    EXPECT_FALSE(fromMessage(m));
    m = toMessage(someTransform());
    for (double& q : m.wxyz) q *= 1.001;
    EXPECT_FALSE(fromMessage(m));
  }
  EXPECT_FALSE(fromMessage(transform_t{}));
}

Session someSession() {
  Session s;
  s.id = 0x7123456789ABCDEF;
  s.start = Time{1'700'000'000'000'001};
  s.writer = "a writer 1.0";
  s.stages = {"odometry", "planes"};
  s.odometry_mode = "fused";
  s.has_odometry = true;
  s.T_body_lidar = someTransform();
  s.config_digest = "0123abcd";
  return s;
}

TEST(ConvertSessionTest, RoundTripIsExact) {
  const Session s = someSession();
  const auto back = fromMessage(throughBytes(toMessage(s, s.start)));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->id, s.id);
  EXPECT_EQ(back->start, s.start);
  EXPECT_EQ(back->writer, s.writer);
  EXPECT_EQ(back->stages, s.stages);
  EXPECT_EQ(back->odometry_mode, s.odometry_mode);
  EXPECT_TRUE(back->has_odometry);
  expectSame(back->T_body_lidar, s.T_body_lidar);
  EXPECT_EQ(back->config_digest, s.config_digest);
}

TEST(ConvertSessionTest, EmptyTextsAndManyStagesSurvive) {
  Session s;
  s.id = 1;
  auto back = fromMessage(throughBytes(toMessage(s, Time{5})));
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->stages.empty());
  EXPECT_EQ(back->odometry_mode, "");
  EXPECT_FALSE(back->has_odometry);
  s.stages.assign(1000, "stage");
  s.writer.assign(40'000, 'w');
  back = fromMessage(throughBytes(toMessage(s, Time{5})));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->stages.size(), 1000u);
  EXPECT_EQ(back->writer, s.writer);
}

TEST(ConvertSessionTest, NoIdAnotherSchemaOrANaNIsRefused) {
  session_t m = toMessage(someSession(), Time{5});
  ASSERT_TRUE(fromMessage(m));
  m.header.session = 0;
  EXPECT_FALSE(fromMessage(m));
  m = toMessage(someSession(), Time{5});
  m.schema = kMessageSchema + 1;
  EXPECT_FALSE(fromMessage(m));
  m = toMessage(someSession(), Time{5});
  m.T_body_lidar.xyz[1] = kNaN;
  EXPECT_FALSE(fromMessage(m));
}

TEST(ConvertOdometrySampleTest, RoundTripIsExactAndNaNRefused) {
  const BodyOdometry sample{Time{1'700'000'000'123'456}, someTransform()};
  spot_odometry_t m = throughBytes(toMessage(sample));
  const auto back = fromMessage(m);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->time, sample.time);
  expectSame(back->T_odom_body, sample.T_odom_body);
  m.T_odom_body.wxyz[2] = kNaN;
  EXPECT_FALSE(fromMessage(m));
}

OdometryEstimate someEstimate() {
  OdometryEstimate e;
  e.time = Time{1'700'000'000'100'000};
  e.scan = 17;
  e.T_odom_body = someTransform();
  e.twist_body << 0.5, 0.25, -0.125, 0.1, -0.2, 0.3;
  e.covariance = someCovariance();
  e.inlier_share = 0.93;
  e.residual_rms_m = 0.012;
  e.num_degenerate = 2;
  e.extrapolated = true;
  e.keyframe = KeyframeId{4};
  e.is_keyframe = true;
  return e;
}

TEST(ConvertEstimateTest, RoundTripIsExact) {
  const OdometryEstimate e = someEstimate();
  const auto back = fromMessage(throughBytes(toMessage(e)));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->time, e.time);
  EXPECT_EQ(back->scan, 17);
  expectSame(back->T_odom_body, e.T_odom_body);
  EXPECT_EQ(back->twist_body, e.twist_body);
  EXPECT_EQ(back->covariance, e.covariance);
  EXPECT_EQ(back->inlier_share, e.inlier_share);
  EXPECT_EQ(back->residual_rms_m, e.residual_rms_m);
  EXPECT_EQ(back->num_degenerate, 2);
  EXPECT_TRUE(back->extrapolated);
  EXPECT_EQ(back->keyframe, e.keyframe);
  EXPECT_TRUE(back->is_keyframe);
  const auto defaults = fromMessage(throughBytes(toMessage(OdometryEstimate{})));
  ASSERT_TRUE(defaults);
  EXPECT_FALSE(defaults->keyframe.valid());
  EXPECT_FALSE(defaults->extrapolated);
}

TEST(ConvertEstimateTest, WhatCannotBeRightIsRefused) {
  const odometry_t good = toMessage(someEstimate());
  odometry_t m = good;
  m.twist_body[4] = kNaN;
  EXPECT_FALSE(fromMessage(m));
  m = good;
  m.covariance[8] = kInfinity;
  EXPECT_FALSE(fromMessage(m));
  m = good;
  m.covariance[7] = -m.covariance[7];
  EXPECT_FALSE(fromMessage(m)) << "negative variance";
  m = good;
  m.covariance[1] += 0.5;
  EXPECT_FALSE(fromMessage(m)) << "not symmetric";
  m = good;
  m.T_odom_body.xyz[0] = kNaN;
  EXPECT_FALSE(fromMessage(m));
  m = good;
  m.scan = -1;
  EXPECT_FALSE(fromMessage(m));
}

TEST(ConvertPoseTest, FillsTheMembersOfBotCorePose) {
  Vector6d twist;
  twist << 1, 2, 3, 4, 5, 6;
  const pose_t m = throughBytes(toPoseMessage(Time{99}, someTransform(), twist));
  EXPECT_EQ(m.utime, 99);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(m.pos[i], someTransform().translation[i]);
    EXPECT_EQ(m.vel[i], 1 + i);
    EXPECT_EQ(m.rotation_rate[i], 4 + i);
    EXPECT_EQ(m.accel[i], 0);
  }
  EXPECT_EQ(m.orientation[0], someTransform().rotation.w());
  EXPECT_EQ(m.orientation[1], someTransform().rotation.x());
  EXPECT_EQ(m.orientation[2], someTransform().rotation.y());
  EXPECT_EQ(m.orientation[3], someTransform().rotation.z());
}

std::vector<VelodynePacket> somePackets(int count) {
  std::vector<VelodynePacket> packets(static_cast<size_t>(count));
  for (size_t i = 0; i < packets.size(); ++i) {
    packets[i].time = Time{1'700'000'000'000'000 + 1327 * static_cast<int64_t>(i)};
    for (size_t b = 0; b < packets[i].bytes.size(); ++b)
      packets[i].bytes[b] = static_cast<uint8_t>(b * 7 + i * 13);
  }
  return packets;
}

TEST(ConvertPacketsTest, RoundTripIsExactUpToTheLargestMessage) {
  for (const int count : {1, 20, kMaxVelodynePackets}) {
    const auto packets = somePackets(count);
    const velodyne_packets_t m = toMessage(packets, 12, 3, true);
    EXPECT_LE(m.getEncodedSize(), 60'000);
    const velodyne_packets_t received = throughBytes(m);
    EXPECT_EQ(received.revolution, 12);
    EXPECT_EQ(received.part, 3);
    EXPECT_EQ(received.last_part, 1);
    EXPECT_EQ(received.header.utime, packets.front().time.us);
    const auto back = fromMessage(received);
    ASSERT_TRUE(back);
    ASSERT_EQ(back->size(), packets.size());
    for (size_t i = 0; i < packets.size(); ++i) {
      EXPECT_EQ((*back)[i].time, packets[i].time);
      EXPECT_EQ((*back)[i].bytes, packets[i].bytes);
    }
  }
}

TEST(ConvertPacketsTest, CountsThatDisagreeAreRefused) {
  EXPECT_FALSE(fromMessage(throughBytes(toMessage(std::vector<VelodynePacket>{}, 0, 0, false))));
  EXPECT_FALSE(fromMessage(throughBytes(toMessage(somePackets(kMaxVelodynePackets + 1), 0, 0, false))));
  velodyne_packets_t m = toMessage(somePackets(3), 0, 0, false);
  m.data.pop_back();
  --m.num_bytes;
  EXPECT_FALSE(fromMessage(throughBytes(m)));
}

}  // namespace
}  // namespace sgraphs
