#include "perception/odometry/scan_queue.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

LidarScan scanAt(int64_t end_us) {
  LidarScan scan;
  scan.begin = Time{end_us - 100};
  scan.end = Time{end_us};
  return scan;
}
BodyOdometry sampleAt(int64_t us) {
  return {Time{us}, SE3()};
}
std::vector<int64_t> timesOf(const std::vector<BodyOdometry>& samples) {
  std::vector<int64_t> times;
  times.reserve(samples.size());
  for (const BodyOdometry& s : samples) times.push_back(s.time.us);
  return times;
}

TEST(ScanQueueTest, WithoutOdometryAScanWaitsForNothing) {
  ScanQueue queue(false);
  queue.addScan(scanAt(1000));
  const auto ready = queue.pop();
  ASSERT_TRUE(ready);
  EXPECT_TRUE(ready->complete);
  EXPECT_FALSE(queue.pop());
}

TEST(ScanQueueTest, AScanWaitsForASampleAtOrAfterItsEnd) {
  ScanQueue queue(true);
  queue.addOdometry(sampleAt(890));
  queue.addScan(scanAt(1000));
  queue.addOdometry(sampleAt(999));
  EXPECT_FALSE(queue.pop());
  queue.addOdometry(sampleAt(1000));
  const auto ready = queue.pop();
  ASSERT_TRUE(ready);
  EXPECT_TRUE(ready->complete);
  EXPECT_EQ(timesOf(ready->odometry), (std::vector<int64_t>{890, 999, 1000}));
}

TEST(ScanQueueTest, SamplesReachFromTheLastBeforeTheBeginToTheFirstAfterTheEnd) {
  ScanQueue queue(true);
  for (int64_t t = 800; t <= 1200; t += 40) queue.addOdometry(sampleAt(t));
  queue.addScan(scanAt(1000));
  EXPECT_EQ(timesOf(queue.pop()->odometry), (std::vector<int64_t>{880, 920, 960, 1000}));
  queue.addScan(scanAt(1110));
  EXPECT_EQ(timesOf(queue.pop()->odometry), (std::vector<int64_t>{1000, 1040, 1080, 1120}));
}

TEST(ScanQueueTest, AClockOffsetIsTakenOffTheSamples) {
  ScanQueue queue(true);
  for (int64_t t = 800; t <= 1040; t += 40) queue.addOdometry(sampleAt(t));
  queue.addScan(scanAt(1000));
  EXPECT_EQ(timesOf(queue.pop()->odometry), (std::vector<int64_t>{880, 920, 960, 1000}));
  // Older samples are still there for a clock that is found to be ahead.
  queue.setClockOffset(Duration{50});
  queue.addScan(scanAt(1060));
  EXPECT_FALSE(queue.pop()) << "1040 is 990";
  for (int64_t t = 1080; t <= 1120; t += 40)
    EXPECT_EQ(queue.addOdometry(sampleAt(t)), ScanQueue::Fate::kKept);
  EXPECT_EQ(timesOf(queue.pop()->odometry), (std::vector<int64_t>{950, 990, 1030, 1070}));
}

// Else samples that arrive after the offset is found would be dropped, and those that came before kept.
TEST(ScanQueueTest, AnOffsetFoundLaterMakesNoSampleLate) {
  ScanQueue queue(true);
  queue.addOdometry(sampleAt(880));
  queue.addOdometry(sampleAt(1000));
  queue.addScan(scanAt(1000));
  ASSERT_TRUE(queue.pop());
  queue.setClockOffset(Duration{100});
  EXPECT_EQ(queue.addOdometry(sampleAt(1020)), ScanQueue::Fate::kKept);
}

TEST(ScanQueueTest, TheTenthLaterScanEndsTheWait) {
  ScanQueue queue(true);
  for (int s = 0; s < 10; ++s) queue.addScan(scanAt(1000 + 100 * s));
  EXPECT_FALSE(queue.pop());
  queue.addScan(scanAt(2000));
  const auto ready = queue.pop();
  ASSERT_TRUE(ready);
  EXPECT_FALSE(ready->complete);
  EXPECT_EQ(ready->scan.end.us, 1000);
  EXPECT_FALSE(queue.pop());  // the next one has nine behind it
}

TEST(ScanQueueTest, SamplesOfAScanThatWentWithoutThemAreLate) {
  ScanQueue queue(true);
  for (int s = 0; s <= 10; ++s) queue.addScan(scanAt(1000 + 100 * s));
  ASSERT_TRUE(queue.pop());
  EXPECT_EQ(queue.addOdometry(sampleAt(950)), ScanQueue::Fate::kLate);
  EXPECT_EQ(queue.addOdometry(sampleAt(1000)), ScanQueue::Fate::kLate);
  EXPECT_EQ(queue.addOdometry(sampleAt(1001)), ScanQueue::Fate::kKept);
  EXPECT_EQ(queue.samples(), 1u);
}

TEST(ScanQueueTest, TimeThatRunsBackwardsIsRefused) {
  ScanQueue queue(true);
  EXPECT_EQ(queue.addScan(scanAt(1000)), ScanQueue::Fate::kKept);
  EXPECT_EQ(queue.addScan(scanAt(1000)), ScanQueue::Fate::kBackwards);
  LidarScan reversed = scanAt(2000);
  std::swap(reversed.begin, reversed.end);
  EXPECT_EQ(queue.addScan(reversed), ScanQueue::Fate::kBackwards);
  EXPECT_EQ(queue.addOdometry(sampleAt(10)), ScanQueue::Fate::kKept);
  EXPECT_EQ(queue.addOdometry(sampleAt(10)), ScanQueue::Fate::kBackwards);
}

TEST(ScanQueueTest, ClosingReleasesEveryScan) {
  ScanQueue queue(true);
  queue.addScan(scanAt(1000));
  queue.addScan(scanAt(1100));
  queue.addOdometry(sampleAt(1050));
  queue.close();
  EXPECT_TRUE(queue.pop()->complete);
  EXPECT_FALSE(queue.pop()->complete);
  EXPECT_EQ(queue.size(), 0u);
}

TEST(ScanQueueTest, SamplesWithoutScansDoNotGrowWithoutBound) {
  ScanQueue queue(true);
  for (int64_t t = 0; t < static_cast<int64_t>(2 * ScanQueue::kMaxSamples); ++t)
    queue.addOdometry(sampleAt(t));
  EXPECT_EQ(queue.samples(), ScanQueue::kMaxSamples);
}

}  // namespace
}  // namespace sgraphs
