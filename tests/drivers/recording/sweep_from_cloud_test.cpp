#include "drivers/recording/ros/sweep_from_cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/base/error.h"
#include "tests/common/test_files.h"
#include "tests/drivers/recording/ros_builder.h"

namespace sgraphs {
namespace {

using test::CloudBuilder;
using test::Wire;
using testing::HasSubstr;

constexpr int64_t kStamp_us = 1'700'000'000'123'456;

// Three points, 10 ms apart, at x = 1, 2, 3, in a layout with gaps.
CloudBuilder threePoints(const std::string& time_name, uint8_t time_type) {
  CloudBuilder cloud;
  cloud.stamp_us = kStamp_us;
  cloud.width = 3;
  cloud.fields = {{"x", 4, 7}, {"y", 8, 7}, {"z", 12, 7}};
  if (!time_name.empty()) cloud.fields.push_back({time_name, 24, time_type});
  cloud.point_step = 40;
  cloud.row_step = 120;
  cloud.data.resize(120);
  for (size_t i = 0; i < 3; ++i) cloud.set(40 * i + 4, static_cast<float>(i + 1));
  return cloud;
}

LidarScan sweepOf(const CloudBuilder& cloud) {
  const auto bytes = cloud.message(Wire::kRos1);
  SweepFromCloud converter;
  return converter.step(readPointCloud(WireReader::ros1(bytes)));
}

struct TimeCase {
  const char* name;
  const char* field;
  uint8_t datatype;
  double first;     // value of the first point's field
  double per_10ms;  // and from point to point
  int64_t end_us;   // of the sweep
};

class SweepTimeTest : public testing::TestWithParam<TimeCase> {};

TEST_P(SweepTimeTest, EveryDriversTimesAreUnderstood) {
  const TimeCase& c = GetParam();
  for (const bool big : {false, true}) {
    CloudBuilder cloud = threePoints(c.field, c.datatype);
    cloud.big = big;
    for (size_t i = 0; i < 3; ++i) {
      cloud.set(40 * i + 4, static_cast<float>(i + 1));
      const double value = c.first + c.per_10ms * static_cast<double>(i);
      if (c.datatype == 6) cloud.set(40 * i + 24, static_cast<uint32_t>(value));
      if (c.datatype == 7) cloud.set(40 * i + 24, static_cast<float>(value));
      if (c.datatype == 8) cloud.set(40 * i + 24, value);
    }
    const LidarScan scan = sweepOf(cloud);
    EXPECT_FALSE(scan.deskewed);
    EXPECT_EQ(scan.end.us, c.end_us);
    EXPECT_EQ(scan.begin.us, c.end_us - 20'000);
    ASSERT_EQ(scan.points.size(), 3u);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(scan.points[static_cast<size_t>(i)].time_us, 10'000 * i - 20'000);
      EXPECT_EQ(scan.points[static_cast<size_t>(i)].position_lidar.x(), static_cast<float>(i + 1));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, SweepTimeTest,
    testing::Values(TimeCase{"SecondsBeforeTheStamp", "time", 7, -0.02, 0.01, kStamp_us},
                    TimeCase{"SecondsAfterTheStamp", "time", 7, 0.0, 0.01, kStamp_us + 20'000},
                    TimeCase{"NanosecondsAfterTheStamp", "t", 6, 0, 1e7, kStamp_us + 20'000},
                    TimeCase{"NanosecondsInFloat", "t", 7, 0, 1e7, kStamp_us + 20'000},
                    TimeCase{"OffsetTime", "offset_time", 6, 5e6, 1e7, kStamp_us + 25'000},
                    TimeCase{"SecondsOfTheEpoch", "timestamp", 8, 1.7e9 + 0.5, 0.01, 1'700'000'000'520'000},
                    TimeCase{"NanosecondsOfTheEpoch", "timestamp", 8, 1.7e18 + 5e8, 1e7,
                             1'700'000'000'520'000}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(SweepFromCloudTest, WithoutTimesASweepIsAtItsStampAndCountsAsDeskewed) {
  const LidarScan scan = sweepOf(threePoints("", 0));
  EXPECT_TRUE(scan.deskewed);
  EXPECT_EQ(scan.end.us, kStamp_us);
  EXPECT_EQ(scan.num_rings, 0);
}

TEST(SweepFromCloudTest, WhatIsNoReturnIsLeftOut) {
  CloudBuilder cloud = threePoints("", 0);
  cloud.set(4, std::numeric_limits<float>::quiet_NaN());
  cloud.set(44, 0.0f);
  const LidarScan scan = sweepOf(cloud);
  ASSERT_EQ(scan.points.size(), 1u);
  EXPECT_EQ(scan.points[0].position_lidar.x(), 3.0f);
}

TEST(SweepFromCloudTest, RowsMayHaveGaps) {
  CloudBuilder cloud = threePoints("", 0);
  cloud.height = 2;
  cloud.width = 1;
  cloud.row_step = 80;
  const LidarScan scan = sweepOf(cloud);
  ASSERT_EQ(scan.points.size(), 2u);
  EXPECT_EQ(scan.points[1].position_lidar.x(), 3.0f);
}

TEST(SweepFromCloudTest, TheUnitOnceToldHoldsForSparseSweeps) {
  CloudBuilder full = threePoints("t", 6), sparse = threePoints("t", 6);
  for (size_t i = 0; i < 3; ++i) full.set(40 * i + 24, static_cast<uint32_t>(1e7 * static_cast<double>(i)));
  for (size_t i = 0; i < 3; ++i) sparse.set(40 * i + 24, static_cast<uint32_t>(2000 * i));
  SweepFromCloud converter;
  const auto first = full.message(Wire::kRos1), second = sparse.message(Wire::kRos1);
  converter.step(readPointCloud(WireReader::ros1(first)));
  const LidarScan scan = converter.step(readPointCloud(WireReader::ros1(second)));
  EXPECT_EQ(scan.end.us, kStamp_us + 4);
  EXPECT_EQ(scan.points[0].time_us, -4);
}

TEST(SweepFromCloudTest, WhatCannotBeUnderstoodIsNamed) {
  const auto failure = [](const CloudBuilder& cloud) {
    return test::messageOf<Error>([&] { sweepOf(cloud); });
  };
  CloudBuilder cloud = threePoints("time", 7);
  for (size_t i = 0; i < 3; ++i) cloud.set(40 * i + 24, 10'000.0f * static_cast<float>(i));  // microseconds
  EXPECT_THAT(failure(cloud), HasSubstr("field 'time'"));
  cloud = threePoints("", 0);
  cloud.fields[1].name = "why";
  EXPECT_THAT(failure(cloud), HasSubstr("no field 'y'"));
  cloud = threePoints("", 0);
  cloud.fields.push_back({"ring", 24, 4});
  cloud.set(24, uint16_t{300});
  EXPECT_THAT(failure(cloud), HasSubstr("'ring'"));
  cloud = threePoints("time", 99);
  EXPECT_THAT(failure(cloud), HasSubstr("datatype 99"));
}

TEST(SweepFromCloudTest, FiguresThatDoNotFitTheDataAreRefused) {
  CloudBuilder cloud = threePoints("", 0);
  cloud.width = 4;
  EXPECT_THROW(sweepOf(cloud), WireError);
  cloud = threePoints("", 0);
  cloud.width = 0xFFFFFFFF;
  cloud.height = 0xFFFFFFFF;
  EXPECT_THROW(sweepOf(cloud), WireError);
  cloud = threePoints("", 0);
  cloud.fields[0].offset = 38;
  EXPECT_THROW(sweepOf(cloud), WireError);
  cloud = threePoints("", 0);
  cloud.point_step = 0;
  EXPECT_THROW(sweepOf(cloud), WireError);
}

TEST(SweepFromCloudTest, EveryCutOfAMessageIsRefused) {
  for (const Wire wire : {Wire::kRos1, Wire::kCdrLittle, Wire::kCdrBig}) {
    const auto bytes = threePoints("time", 7).message(wire);
    // The last member, is_dense, is not looked at.
    for (size_t size = 0; size + 1 < bytes.size(); ++size) {
      const std::span<const uint8_t> cut(bytes.data(), size);
      EXPECT_THROW(readPointCloud(wire == Wire::kRos1 ? WireReader::ros1(cut) : WireReader::cdr(cut)),
                   WireError);
    }
  }
}

}  // namespace
}  // namespace sgraphs
