#include "drivers/velodyne/packet_monitor.h"

#include <gtest/gtest.h>

#include "tests/drivers/velodyne/packet_builder.h"

namespace sgraphs {
namespace {

Vlp16Packet packetOf(ReturnMode mode) {
  Vlp16Packet packet;
  packet.mode = mode;
  return packet;
}

// Feeds packets at the given instants; returns the monitor.
PacketMonitor fed(const std::vector<double>& times_us, ReturnMode mode = ReturnMode::kStrongest) {
  PacketMonitor monitor;
  for (const double t : times_us) monitor.step(Time{std::llround(1e9 + t)}, packetOf(mode));
  return monitor;
}

TEST(PacketMonitorTest, SteadyPacketsLoseNothing) {
  std::vector<double> single, dual;
  for (int i = 0; i < 5000; ++i) {
    single.push_back(i * 1327.104);
    dual.push_back(i * 663.552);
  }
  EXPECT_EQ(fed(single).lost(), 0);
  EXPECT_EQ(fed(dual, ReturnMode::kDual).lost(), 0);
  EXPECT_FALSE(fed(dual, ReturnMode::kDual).thirtyTwoBeams());
}

TEST(PacketMonitorTest, AStepOfNPeriodsHasLostNMinusOne) {
  EXPECT_EQ(fed({0, 1327.104, 3 * 1327.104, 4 * 1327.104, 14 * 1327.104}).lost(), 1 + 9);
  EXPECT_EQ(fed({0, 2 * 663.552, 3 * 663.552}, ReturnMode::kDual).lost(), 1);
}

TEST(PacketMonitorTest, ThirtyTwoBeamsAreToldByTheirRhythm) {
  std::vector<double> hdl32, vlp32;
  for (int i = 0; i < 6; ++i) {
    hdl32.push_back(i * 552.96);
    vlp32.push_back(i * 663.552);
  }
  EXPECT_TRUE(fed(hdl32).thirtyTwoBeams());
  EXPECT_TRUE(fed(hdl32, ReturnMode::kDual).thirtyTwoBeams());
  EXPECT_TRUE(fed(vlp32).thirtyTwoBeams());
}

TEST(PacketMonitorTest, ACondemnedStreamIsRefusedAsAWhole) {
  PacketMonitor monitor = fed({0, 553, 1106, 1659});
  ASSERT_TRUE(monitor.thirtyTwoBeams());
  EXPECT_EQ(monitor.step(Time{1'000'000'000 + 1659 + 1327}, packetOf(ReturnMode::kStrongest)).fault,
            PacketFault::kThirtyTwoBeams);
}

TEST(PacketMonitorTest, OneSpoiledStampCondemnsNobody) {
  EXPECT_FALSE(fed({0, 553, 1327 + 553, 2654, 3981}).thirtyTwoBeams());
}

TEST(PacketMonitorTest, RepeatedAndLatePacketsAreRefusedAndCountNoLoss) {
  PacketMonitor monitor = fed({0, 1327, 2654});
  EXPECT_EQ(monitor.step(Time{1'000'000'000 + 2654}, packetOf(ReturnMode::kStrongest)).fault,
            PacketFault::kOutOfOrder);
  EXPECT_EQ(monitor.step(Time{1'000'000'000 + 1327}, packetOf(ReturnMode::kStrongest)).fault,
            PacketFault::kOutOfOrder);
  const auto verdict = monitor.step(Time{1'000'000'000 + 3981}, packetOf(ReturnMode::kStrongest));
  EXPECT_EQ(verdict.fault, PacketFault::kNone);
  EXPECT_EQ(monitor.lost(), 0);
}

TEST(PacketMonitorTest, AClockSetBackBeginsANewStretch) {
  PacketMonitor monitor = fed({0, 1327});
  const auto verdict = monitor.step(Time{1'000'000'000 - 60'000'000}, packetOf(ReturnMode::kStrongest));
  EXPECT_EQ(verdict.fault, PacketFault::kNone);
  EXPECT_TRUE(verdict.clock_jumped_back);
  EXPECT_EQ(monitor.lost(), 0);
}

}  // namespace
}  // namespace sgraphs
