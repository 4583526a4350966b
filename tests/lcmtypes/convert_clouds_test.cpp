#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lcmtypes/convert/convert.h"
#include "tests/lcmtypes/through_bytes.h"

namespace sgraphs {
namespace {

using test::throughBytes;

LidarScan someScan(size_t points) {
  LidarScan scan;
  scan.end = Time{1'700'000'000'100'000};
  scan.begin = scan.end - Duration{99'000};
  scan.sequence = 7;
  scan.num_rings = 16;
  for (size_t i = 0; i < points; ++i) {
    const auto t = static_cast<float>(i);
    LidarPoint p;
    p.position_lidar = {10 * std::cos(t), 10 * std::sin(t), 0.001f * t};
    p.time_us = static_cast<int32_t>(-99'000 + static_cast<int64_t>(99'000 * i / points));
    p.ring = static_cast<uint8_t>(15 - i % 16);
    scan.points.push_back(p);
  }
  return scan;
}

void expectSamePoints(const LidarScan& a, const LidarScan& b) {
  ASSERT_EQ(a.points.size(), b.points.size());
  for (size_t i = 0; i < a.points.size(); ++i) {
    ASSERT_EQ(a.points[i].position_lidar, b.points[i].position_lidar) << i;
    ASSERT_EQ(a.points[i].time_us, b.points[i].time_us) << i;
    ASSERT_EQ(a.points[i].ring, b.points[i].ring) << i;
  }
}

TEST(ConvertScanTest, RoundTripIsExactFromOnePointToManyChunks) {
  for (const size_t points : {1u, 2823u, 2824u, 28'900u, 131'072u}) {
    const LidarScan scan = someScan(points);
    const auto messages = toMessages(scan);
    for (const auto& m : messages) EXPECT_LE(m.getEncodedSize(), test::kDatagramBytes);
    const auto back = fromMessages(throughBytes(messages));
    ASSERT_TRUE(back) << points;
    EXPECT_EQ(back->end, scan.end);
    EXPECT_EQ(back->begin, scan.begin);
    EXPECT_EQ(back->sequence, 7);
    EXPECT_FALSE(back->deskewed);
    if (points > 16) {
      EXPECT_EQ(back->num_rings, 16);
    }
    expectSamePoints(*back, scan);
  }
}

TEST(ConvertScanTest, AnEmptyScanIsOneMessage) {
  LidarScan scan = someScan(1);
  scan.points.clear();
  const auto messages = toMessages(scan);
  ASSERT_EQ(messages.size(), 1u);
  const auto back = fromMessages(throughBytes(messages));
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->points.empty());
  EXPECT_EQ(back->end, scan.end);
}

TEST(ConvertScanTest, WithoutTimesAndRingsTheScanIsDeskewedAndUnorganised) {
  LidarScan scan = someScan(100);
  scan.deskewed = true;
  scan.num_rings = 0;
  for (LidarPoint& p : scan.points) p.time_us = p.ring = 0;
  const auto back = fromMessages(throughBytes(toMessages(scan)));
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->deskewed);
  EXPECT_EQ(back->num_rings, 0);
  EXPECT_EQ(back->begin, back->end);
  expectSamePoints(*back, scan);
}

TEST(ConvertScanTest, PointsThatAreNotFiniteAreLeftOut) {
  LidarScan scan = someScan(10);
  scan.points[3].position_lidar.x() = static_cast<float>(test::kNaN);
  scan.points[7].position_lidar.z() = std::numeric_limits<float>::infinity();
  const auto back = fromMessages(throughBytes(toMessages(scan)));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->points.size(), 8u);
  for (const LidarPoint& p : back->points) EXPECT_TRUE(p.position_lidar.allFinite());
}

TEST(ConvertScanTest, AMissingOrMisplacedChunkIsRefused) {
  const auto chunks = toMessages(someScan(10'000));
  ASSERT_EQ(chunks.size(), 4u);
  for (size_t lost = 0; lost < chunks.size(); ++lost) {
    auto rest = chunks;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(lost));
    EXPECT_FALSE(fromMessages(rest)) << "chunk " << lost;
  }
  auto swapped = chunks;
  std::swap(swapped[1], swapped[2]);
  EXPECT_FALSE(fromMessages(swapped));
  auto mixed = chunks;
  mixed[2].sweep = 8;
  EXPECT_FALSE(fromMessages(mixed));
  EXPECT_FALSE(fromMessages(std::span<const lidar_points_t>{}));
}

TEST(ConvertScanTest, CountsThatDisagreeAndTimesAfterTheEndAreRefused) {
  const auto good = toMessages(someScan(10));
  auto bad = good;
  bad[0].num_points = 9;
  EXPECT_FALSE(fromMessages(bad));
  bad = good;
  bad[0].time_us.pop_back();
  --bad[0].num_times;
  EXPECT_FALSE(fromMessages(bad));
  bad = good;
  bad[0].ring.pop_back();
  --bad[0].num_rings;
  EXPECT_FALSE(fromMessages(bad));
  bad = good;
  bad[0].time_us[5] = 1;
  EXPECT_FALSE(fromMessages(bad));
}

Keyframe someKeyframe(size_t points, float reach_m = 30) {
  Keyframe k;
  Vector6d xi;
  xi << 1, 2, 0.5, 0.1, -0.2, 1.2;
  k.id = KeyframeId{3};
  k.time = Time{1'700'000'001'000'000};
  k.scan = 31;
  k.T_odom_body = se3Exp(xi);
  RelativePose r;
  r.kind = RelativePoseKind::kNeighbour;
  r.from = KeyframeId{2};
  r.to = KeyframeId{3};
  r.T_from_to = se3Exp(0.3 * xi);
  r.covariance.diagonal() << 1e-4, 2e-4, 3e-4, 1e-6, 2e-6, 3e-6;
  k.relative_poses = {r, r};
  k.relative_poses[1].kind = RelativePoseKind::kOdometry;
  k.up_body = Eigen::Vector3d(0.01, -0.02, 1).normalized();
  k.up_sigma_rad = 0.004;
  k.T_keyframe_body = {se3Exp(-0.1 * xi), SE3()};
  k.T_body_lidar = se3Exp(0.2 * xi);
  for (size_t i = 0; i < points; ++i) {
    const auto t = static_cast<float>(i);
    KeyframePoint p;
    p.position_body = {reach_m * std::cos(t), reach_m * std::sin(t), std::fmod(0.0137f * t, 3.0f)};
    p.scan = static_cast<uint8_t>(i % 2);
    p.count = static_cast<uint8_t>(1 + i % 255);
    k.points.push_back(p);
  }
  return k;
}

void expectSameHead(const Keyframe& a, const Keyframe& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.scan, b.scan);
  EXPECT_EQ(a.T_odom_body.translation, b.T_odom_body.translation);
  EXPECT_EQ(a.T_odom_body.rotation.coeffs(), b.T_odom_body.rotation.coeffs());
  EXPECT_EQ(a.up_body, b.up_body);
  EXPECT_EQ(a.up_sigma_rad, b.up_sigma_rad);
  EXPECT_EQ(a.T_body_lidar.translation, b.T_body_lidar.translation);
  ASSERT_EQ(a.T_keyframe_body.size(), b.T_keyframe_body.size());
  for (size_t i = 0; i < a.T_keyframe_body.size(); ++i)
    EXPECT_EQ(a.T_keyframe_body[i].translation, b.T_keyframe_body[i].translation);
  ASSERT_EQ(a.relative_poses.size(), b.relative_poses.size());
  for (size_t i = 0; i < a.relative_poses.size(); ++i) {
    EXPECT_EQ(a.relative_poses[i].kind, b.relative_poses[i].kind);
    EXPECT_EQ(a.relative_poses[i].from, b.relative_poses[i].from);
    EXPECT_EQ(a.relative_poses[i].to, b.relative_poses[i].to);
    EXPECT_EQ(a.relative_poses[i].T_from_to.translation, b.relative_poses[i].T_from_to.translation);
    EXPECT_EQ(a.relative_poses[i].covariance, b.relative_poses[i].covariance);
  }
}

TEST(ConvertKeyframeTest, RoundTripKeepsAllButAMillimetre) {
  for (const size_t points : {1u, 6000u, 6001u, 50'000u}) {
    const Keyframe k = someKeyframe(points);
    const auto messages = toMessages(k);
    for (const auto& m : messages) EXPECT_LE(m.getEncodedSize(), test::kDatagramBytes);
    const auto back = fromMessages(throughBytes(messages));
    ASSERT_TRUE(back) << points;
    expectSameHead(*back, k);
    ASSERT_EQ(back->points.size(), points);
    for (size_t i = 0; i < points; ++i) {
      ASSERT_LT((back->points[i].position_body - k.points[i].position_body).cwiseAbs().maxCoeff(), 1.003e-3f);
      ASSERT_EQ(back->points[i].scan, k.points[i].scan);
      ASSERT_EQ(back->points[i].count, k.points[i].count);
    }
  }
}

TEST(ConvertKeyframeTest, FarPointsAreCoarserAndNotCutOff) {
  const Keyframe k = someKeyframe(500, 130);
  const auto back = fromMessages(throughBytes(toMessages(k)));
  ASSERT_TRUE(back);
  for (size_t i = 0; i < k.points.size(); ++i)
    EXPECT_LT((back->points[i].position_body - k.points[i].position_body).cwiseAbs().maxCoeff(), 2.1e-3f);
}

TEST(ConvertKeyframeTest, AKeyframeWithoutPointsOrMeasurementsSurvives) {
  Keyframe k;
  k.id = KeyframeId{0};
  k.T_keyframe_body = {SE3()};
  const auto messages = toMessages(k);
  ASSERT_EQ(messages.size(), 1u);
  const auto back = fromMessages(throughBytes(messages));
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->points.empty());
  EXPECT_TRUE(back->relative_poses.empty());
  EXPECT_EQ(back->up_body, Eigen::Vector3d::Zero());
}

TEST(ConvertKeyframeTest, ALostChunkCostsItsPointsOnly) {
  const Keyframe k = someKeyframe(15'000);
  const auto chunks = toMessages(k);
  ASSERT_EQ(chunks.size(), 3u);
  for (size_t lost = 0; lost < chunks.size(); ++lost) {
    auto rest = chunks;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(lost));
    const auto back = fromMessages(throughBytes(rest));
    ASSERT_TRUE(back) << "chunk " << lost;
    expectSameHead(*back, k);
    EXPECT_EQ(back->points.size(), 15'000u - static_cast<size_t>(chunks[lost].num_points));
  }
  EXPECT_FALSE(fromMessages(std::span<const keyframe_t>{}));
}

template <typename Change>
bool acceptedAfter(Change change) {
  auto messages = toMessages(someKeyframe(10));
  change(messages[0]);
  return fromMessages(messages).has_value();
}

TEST(ConvertKeyframeTest, WhatCannotBeRightIsRefused) {
  constexpr double kBad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(acceptedAfter([](keyframe_t&) {}));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.keyframe = -1; }));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.resolution_m = 0; }));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.resolution_m = kBad; }));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.up_body[1] = kBad; }));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.up_sigma_rad = kBad; }));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.T_odom_body.xyz[0] = kBad; }));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.T_body_lidar.wxyz[0] = 7; }));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.T_keyframe_body[0].xyz[2] = kBad; }));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.relative_poses[0].kind = 3; }));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.relative_poses[0].from_keyframe = -1; }));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.relative_poses[1].covariance[7] = -1; }));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.relative_poses[1].covariance[0] = kBad; }));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.num_points = 9; }));
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.points[6] = 2; })) << "no such scan";
  EXPECT_FALSE(acceptedAfter([](keyframe_t& m) { m.points[7] = 0; })) << "a centroid of no points";
}

TEST(ConvertKeyframeTest, ChunksOfTwoKeyframesDoNotMix) {
  auto chunks = toMessages(someKeyframe(15'000));
  chunks[1].keyframe = 4;
  EXPECT_FALSE(fromMessages(chunks));
}

}  // namespace
}  // namespace sgraphs
