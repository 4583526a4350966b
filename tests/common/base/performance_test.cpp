#include "common/base/performance.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

TEST(LatencyHistogramTest, PercentilesAreExactToFivePercent) {
  LatencyHistogram histogram;
  for (int64_t us = 1; us <= 10000; ++us) histogram.add(us);
  EXPECT_EQ(histogram.count(), 10000);
  EXPECT_NEAR(static_cast<double>(histogram.percentileUs(0.5)), 5000, 250);
  EXPECT_NEAR(static_cast<double>(histogram.percentileUs(0.99)), 9900, 500);
}

TEST(LatencyHistogramTest, ExtremesStayInBounds) {
  LatencyHistogram histogram;
  EXPECT_EQ(histogram.percentileUs(0.5), 0);
  histogram.add(-5);
  EXPECT_EQ(histogram.percentileUs(0.5), 1);
  histogram.add(INT64_MAX);
  EXPECT_GT(histogram.percentileUs(1.0), int64_t{1} << 39);
}

TEST(MemoryTest, PeakIsNotBelowTheMemoryInUse) {
  EXPECT_GT(residentBytes(), 100'000);
  EXPECT_GE(peakResidentMib() * 1.05, static_cast<double>(residentBytes()) / (1 << 20));
}

}  // namespace
}  // namespace sgraphs
