#include "drivers/velodyne/vlp16_decoder.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/drivers/velodyne/packet_builder.h"

namespace sgraphs {
namespace {

using test::PacketBytes;
using test::TurningSensor;

constexpr int64_t kStart_us = 1'700'000'000'000'000;

std::vector<LidarScan> decode(TurningSensor sensor, int packets, const Vlp16Config& config = {},
                              RevolutionAssembler* out = nullptr) {
  RevolutionAssembler assembler(config);
  std::vector<LidarScan> scans;
  for (int i = 0; i < packets; ++i) {
    const Time time{kStart_us + sensor.timeUs()};
    if (auto scan = assembler.step(time, sensor.next())) scans.push_back(std::move(*scan));
  }
  if (out) *out = assembler;
  return scans;
}

// The manual's conversion (chapter 9.3), written out for one firing.
Eigen::Vector3d truth_lidar(double azimuth_deg, double range_m, int laser) {
  static const double kElevation[16] = {-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};
  static const double kOffset_mm[16] = {11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1,
                                        5.1,  -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2};
  const double a = azimuth_deg * std::numbers::pi / 180, w = kElevation[laser] * std::numbers::pi / 180;
  const double x_manual = range_m * std::cos(w) * std::sin(a), y_manual = range_m * std::cos(w) * std::cos(a);
  return {y_manual, -x_manual, range_m * std::sin(w) + 1e-3 * kOffset_mm[laser]};
}

TEST(RevolutionAssemblerTest, EveryPointIsWhereItWasFired) {
  TurningSensor sensor;
  sensor.azimuth_cdeg = 35000;
  const std::vector<LidarScan> scans = decode(sensor, 200);
  ASSERT_EQ(scans.size(), 2u);
  for (const LidarScan& scan : scans) {
    EXPECT_EQ(scan.num_rings, 16);
    for (const LidarPoint& p : scan.points) {
      const int laser = p.ring < 8 ? 2 * p.ring : 2 * (p.ring - 8) + 1;
      const auto t_us = static_cast<double>((scan.end - Time{kStart_us}).us + p.time_us);
      const double azimuth_deg = std::fmod(350 + 360.0 * 10 * t_us * 1e-6, 360);
      // 0.005 deg from the azimuth's rounding and 0.5 us from the time's, at 5 m.
      EXPECT_LT((p.position_lidar.cast<double>() - truth_lidar(azimuth_deg, 5.0, laser)).norm(), 1.2e-3);
    }
  }
}

TEST(RevolutionAssemblerTest, RevolutionsAreCompleteAtEverySpeedAndReturnMode) {
  for (const double rate_hz : {5.0, 10.0, 20.0})
    for (const bool dual : {false, true}) {
      TurningSensor sensor;
      sensor.rate_hz = rate_hz;
      sensor.dual = dual;
      sensor.azimuth_cdeg = 12345;
      const int packets = static_cast<int>(4.5 / rate_hz * 1e6 / (dual ? 663.552 : 1327.104));
      const std::vector<LidarScan> scans = decode(sensor, packets);
      ASSERT_EQ(scans.size(), 3u) << rate_hz << " Hz, dual " << dual;
      const double columns = 1e6 / rate_hz / kVlp16Sequence_us;
      for (size_t i = 0; i < scans.size(); ++i) {
        EXPECT_EQ(scans[i].sequence, static_cast<int64_t>(i));
        EXPECT_NEAR((scans[i].end - scans[i].begin).seconds(), 1 / rate_hz, 2.5e-4);
        EXPECT_NEAR(static_cast<double>(scans[i].points.size()), columns * 16 * (dual ? 2 : 1), 64);
        EXPECT_NEAR(scans[i].points.back().column, columns - 1, 2.1);
      }
      // Nothing is lost between two revolutions, and nothing is in both.
      EXPECT_NEAR(static_cast<double>((scans[1].begin - scans[0].end).us), 55.296 - 15 * 2.304, 1.01);
    }
}

TEST(RevolutionAssemblerTest, CutsBetweenBlocksAtAnyAngle) {
  for (const double cut_deg : {0.0, 17.3, 90.0, 180.0, 359.9}) {
    Vlp16Config config;
    config.cut_azimuth_deg = cut_deg;
    const std::vector<LidarScan> scans = decode(TurningSensor{}, 320, config);
    ASSERT_GE(scans.size(), 3u) << "cut at " << cut_deg;
    for (const LidarScan& scan : scans) {
      const Eigen::Vector3f first = scan.points.front().position_lidar;
      const double azimuth_deg = std::atan2(-first.y(), first.x()) * 180 / std::numbers::pi;
      const double past_cut_deg = std::remainder(azimuth_deg - cut_deg, 360);
      EXPECT_GE(past_cut_deg, -0.006) << "cut at " << cut_deg;
      EXPECT_LT(past_cut_deg, 0.41) << "cut at " << cut_deg;
    }
  }
}

TEST(RevolutionAssemblerTest, TimesEndAtZeroAndNeverDecrease) {
  for (const bool dual : {false, true}) {
    TurningSensor sensor;
    sensor.dual = dual;
    const std::vector<LidarScan> scans = decode(sensor, 400);
    ASSERT_FALSE(scans.empty());
    for (const LidarScan& scan : scans) {
      EXPECT_EQ(scan.points.back().time_us, 0);
      EXPECT_EQ(scan.points.front().time_us, -(scan.end - scan.begin).us);
      for (size_t i = 1; i < scan.points.size(); ++i) {
        ASSERT_LE(scan.points[i - 1].time_us, scan.points[i].time_us);
        ASSERT_LE(scan.points[i - 1].column, scan.points[i].column);
      }
    }
  }
}

TEST(RevolutionAssemblerTest, DualReturnsAreKeptWhereTheyDiffer) {
  TurningSensor sensor;
  const auto distances = [](int block, int, int laser) {
    // Even blocks hold the last return; the strongest differs for the odd lasers only.
    return static_cast<uint16_t>(block % 2 == 0 ? 4000 : (laser % 2 == 1 ? 3000 : 4000));
  };
  RevolutionAssembler assembler;
  std::optional<LidarScan> scan;
  for (int i = 0; i < 400 && !scan; ++i) {
    const double azimuth = std::fmod(6 * 40.0 * i, 36000);
    const auto time_us = std::llround(663.552 * i);
    const PacketBytes bytes =
        test::makePacket(azimuth, 40.0, static_cast<uint32_t>(time_us), true, distances, 0x39, 0x22);
    scan = assembler.step(Time{kStart_us + time_us}, bytes);
  }
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->points.size(), 900u * 2u * 24u);  // 900 columns of 0.4 deg, 2 firings, 16 + 8 returns
  for (size_t i = 1; i < scan->points.size(); ++i) {
    const LidarPoint &a = scan->points[i - 1], &b = scan->points[i];
    if (a.ring != b.ring || a.column != b.column) continue;
    EXPECT_NEAR(a.position_lidar.norm(), 8.0f, 0.02f);
    EXPECT_NEAR(b.position_lidar.norm(), 6.0f, 0.02f);
    EXPECT_EQ(a.time_us, b.time_us);
  }
}

TEST(RevolutionAssemblerTest, NoReturnAndOutOfRangeAreLeftOut) {
  RevolutionAssembler assembler(Vlp16Config{0.0, 1.0, 10.0});
  const auto distances = [](int, int, int laser) -> uint16_t {
    if (laser == 0) return 0;     // no return
    if (laser == 1) return 499;   // 0.998 m
    if (laser == 2) return 500;   // 1 m
    if (laser == 3) return 5000;  // 10 m
    if (laser == 4) return 5001;
    return 0;
  };
  std::optional<LidarScan> scan;
  for (int i = 0; i < 300 && !scan; ++i) {
    const auto time_us = std::llround(1327.104 * i);
    scan = assembler.step(Time{kStart_us + time_us},
                          test::makePacket(std::fmod(480.0 * i, 36000), 40, static_cast<uint32_t>(time_us),
                                           false, distances, 0x37, 0x22));
  }
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->points.size(), 900u * 2u * 2u);
  for (const LidarPoint& p : scan->points) EXPECT_TRUE(p.ring == 1 || p.ring == 9);
}

TEST(RevolutionAssemblerTest, AGapInsideARevolutionIsCountedAndTheRestDelivered) {
  TurningSensor sensor;
  RevolutionAssembler assembler;
  std::vector<std::pair<LidarScan, int64_t>> scans;
  for (int i = 0; i < 400; ++i) {
    if (i == 100) sensor.skip(20);
    const Time time{kStart_us + sensor.timeUs()};
    if (auto scan = assembler.step(time, sensor.next()))
      scans.emplace_back(*scan, assembler.lostInLastRevolution());
  }
  ASSERT_GE(scans.size(), 3u);
  EXPECT_EQ(assembler.counts().lost_packets, 20);
  EXPECT_EQ(scans[0].second, 20);
  EXPECT_EQ(scans[1].second, 0);
  EXPECT_NEAR(static_cast<double>(scans[0].first.points.size()), (75.35 - 20) * 384, 400);
  // Columns and times behind the gap are those of a whole revolution.
  EXPECT_NEAR(scans[0].first.points.back().column, 1807, 3);
  EXPECT_NEAR((scans[0].first.end - scans[0].first.begin).seconds(), 0.1, 2e-4);
}

TEST(RevolutionAssemblerTest, AGapOfMoreThanATurnDropsTheTornRevolution) {
  TurningSensor sensor;
  RevolutionAssembler assembler;
  int delivered = 0;
  for (int i = 0; i < 500; ++i) {
    if (i == 100) sensor.skip(90);
    const Time time{kStart_us + sensor.timeUs()};
    if (const auto scan = assembler.step(time, sensor.next())) {
      ++delivered;
      EXPECT_NEAR(static_cast<double>(scan->points.size()), 75.35 * 384, 400);
    }
  }
  // 590 packets are 7.83 turns: of the 6 revolutions between cuts the gap spoils two.
  EXPECT_EQ(delivered, 4);
  EXPECT_EQ(assembler.counts().dropped_revolutions, 3);  // with the one before the first cut
}

TEST(RevolutionAssemblerTest, AStandingSensorFillsNoMemory) {
  TurningSensor sensor;
  RevolutionAssembler assembler;
  for (int i = 0; i < 200; ++i) assembler.step(Time{kStart_us + sensor.timeUs()}, sensor.next());
  const int64_t delivered = assembler.counts().revolutions, dropped = assembler.counts().dropped_revolutions;
  sensor.rate_hz = 0;
  for (int i = 0; i < 2000; ++i) assembler.step(Time{kStart_us + sensor.timeUs()}, sensor.next());
  EXPECT_EQ(assembler.counts().revolutions, delivered);
  EXPECT_GE(assembler.counts().dropped_revolutions, dropped + 1);
}

TEST(RevolutionAssemblerTest, AnAzimuthOutOfRangeSpoilsNoRevolution) {
  TurningSensor sensor;
  const std::vector<LidarScan> clean = decode(sensor, 250);
  RevolutionAssembler assembler;
  std::vector<LidarScan> scans;
  for (int i = 0; i < 250; ++i) {
    const Time time{kStart_us + sensor.timeUs()};
    PacketBytes bytes = sensor.next();
    test::setAzimuth(bytes, i % 12, 36000u + static_cast<unsigned>(i));
    if (auto scan = assembler.step(time, bytes)) scans.push_back(*scan);
  }
  ASSERT_EQ(scans.size(), clean.size());
  EXPECT_EQ(assembler.counts().repaired_azimuths, 250);
  for (size_t s = 0; s < scans.size(); ++s) {
    const auto size = static_cast<double>(clean[s].points.size());
    EXPECT_NEAR(static_cast<double>(scans[s].points.size()), size, 33);
  }
}

TEST(RevolutionAssemblerTest, EachFaultIsCountedUnderItsName) {
  RevolutionAssembler assembler;
  TurningSensor sensor;
  for (int i = 0; i < 10; ++i) {
    const Time time{kStart_us + sensor.timeUs()};
    const PacketBytes good = sensor.next();
    PacketBytes wrong_flag = good;
    wrong_flag[300] = 0;
    assembler.step(time, wrong_flag);
    assembler.step(time, std::span(good).first(1000));
    assembler.step(time, good);
    assembler.step(time, good);
  }
  const auto rejected = [&](PacketFault fault) {
    return assembler.counts().rejected[static_cast<size_t>(fault)];
  };
  EXPECT_EQ(assembler.counts().packets, 10);
  EXPECT_EQ(rejected(PacketFault::kWrongSize), 10);
  EXPECT_EQ(rejected(PacketFault::kWrongBlockFlag), 10);
  EXPECT_EQ(rejected(PacketFault::kOutOfOrder), 10);
  EXPECT_EQ(assembler.counts().lost_packets, 0);
}

TEST(RevolutionAssemblerTest, AThirtyTwoBeamSensorDeliversNothing) {
  RevolutionAssembler assembler;
  int delivered = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto time_us = std::llround(552.96 * i);
    const PacketBytes bytes = test::makePacket(
        std::fmod(12 * 16.6 * i, 36000), 16.6, static_cast<uint32_t>(time_us), false,
        [](int, int, int) { return uint16_t{2500}; }, 0x37, 0x22);
    delivered += assembler.step(Time{kStart_us + time_us}, bytes).has_value();
  }
  EXPECT_EQ(delivered, 0);
  EXPECT_EQ(assembler.counts().rejected[static_cast<size_t>(PacketFault::kThirtyTwoBeams)], 997);
}

}  // namespace
}  // namespace sgraphs
