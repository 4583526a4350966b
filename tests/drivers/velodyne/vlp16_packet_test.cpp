#include "drivers/velodyne/vlp16_packet.h"

#include <gtest/gtest.h>

#include "tests/drivers/velodyne/packet_builder.h"

namespace sgraphs {
namespace {

using test::PacketBytes;

PacketBytes packetAt(double azimuth_cdeg, uint8_t mode = 0x37, uint8_t product = 0x22, bool dual = false) {
  return test::makePacket(
      azimuth_cdeg, 40.0, 0x12345678, dual,
      [](int block, int firing, int laser) {
        return static_cast<uint16_t>(1000 * block + 100 * firing + laser);
      },
      mode, product);
}

TEST(Vlp16PacketTest, ReadsStampAzimuthsAndChannels) {
  const PacketBytes bytes = packetAt(35900);
  Vlp16Packet packet;
  ASSERT_EQ(parsePacket(bytes, packet), PacketFault::kNone);
  EXPECT_EQ(packet.stamp_us, 0x12345678u);
  EXPECT_EQ(packet.mode, ReturnMode::kStrongest);
  EXPECT_EQ(packet.azimuth_cdeg[0], 35900);
  EXPECT_EQ(packet.azimuth_cdeg[3], 20);
  EXPECT_EQ(packet.distance(7, 1, 9), 7109);
  EXPECT_EQ(packet.reflectivity(7, 1, 9), 109);
  EXPECT_EQ(packet.repaired_azimuths, 0);
}

TEST(Vlp16PacketTest, FiringTimesFollowTheManual) {
  Vlp16Packet single, dual;
  const PacketBytes single_bytes = packetAt(0), dual_bytes = packetAt(0, 0x39, 0x22, true);
  ASSERT_EQ(parsePacket(single_bytes, single), PacketFault::kNone);
  ASSERT_EQ(parsePacket(dual_bytes, dual), PacketFault::kNone);
  EXPECT_DOUBLE_EQ(single.firing_us(0, 0, 0), 0);
  EXPECT_DOUBLE_EQ(single.firing_us(11, 1, 15), 55.296 * 23 + 2.304 * 15);
  EXPECT_DOUBLE_EQ(dual.firing_us(11, 1, 15), 55.296 * 11 + 2.304 * 15);
  EXPECT_DOUBLE_EQ(dual.firing_us(4, 0, 3), dual.firing_us(5, 0, 3));
}

TEST(Vlp16PacketTest, WrongSizeIsRefused) {
  const PacketBytes bytes = packetAt(0);
  Vlp16Packet packet;
  EXPECT_EQ(parsePacket({}, packet), PacketFault::kWrongSize);
  EXPECT_EQ(parsePacket(std::span(bytes).first(1205), packet), PacketFault::kWrongSize);
  EXPECT_EQ(parsePacket(std::vector<uint8_t>(1248, 0xFF), packet), PacketFault::kWrongSize);
}

TEST(Vlp16PacketTest, WrongFlagInAnyBlockIsRefused) {
  for (size_t block = 0; block < 12; ++block) {
    PacketBytes bytes = packetAt(0);
    bytes[100 * block + 1] = 0xDD;  // the lower laser bank of an HDL-64
    Vlp16Packet packet;
    EXPECT_EQ(parsePacket(bytes, packet), PacketFault::kWrongBlockFlag) << "block " << block;
  }
}

TEST(Vlp16PacketTest, ReturnModeMustBeKnownWhereTheProductIs) {
  Vlp16Packet packet;
  EXPECT_EQ(parsePacket(packetAt(0, 0x42, 0x22), packet), PacketFault::kUnknownReturnMode);
  EXPECT_EQ(parsePacket(packetAt(0, 0x42, 0x21), packet), PacketFault::kUnknownReturnMode);
}

TEST(Vlp16PacketTest, OldFirmwareWithoutFactoryBytesIsAccepted) {
  Vlp16Packet packet;
  const PacketBytes model_byte_of_another = packetAt(0, 0x37, 0x21);
  EXPECT_EQ(parsePacket(model_byte_of_another, packet), PacketFault::kNone);
  EXPECT_TRUE(packet.factory_bytes_defined);
  const PacketBytes undefined = packetAt(0, 0, 0);
  ASSERT_EQ(parsePacket(undefined, packet), PacketFault::kNone);
  EXPECT_FALSE(packet.factory_bytes_defined);
  EXPECT_FALSE(packet.dual());
  const PacketBytes undefined_dual = packetAt(0, 0, 0, true);
  ASSERT_EQ(parsePacket(undefined_dual, packet), PacketFault::kNone);
  EXPECT_TRUE(packet.dual());
}

TEST(Vlp16PacketTest, AzimuthOutOfRangeLiesBetweenItsNeighbours) {
  for (const int block : {0, 5, 11})
    for (const unsigned spoiled : {36000u, 65535u}) {
      PacketBytes bytes = packetAt(35800);  // wraps at block 5
      test::setAzimuth(bytes, block, spoiled);
      Vlp16Packet packet;
      ASSERT_EQ(parsePacket(bytes, packet), PacketFault::kNone);
      EXPECT_EQ(packet.repaired_azimuths, 1);
      const double truth = std::fmod(35800 + 40.0 * block, 36000);
      EXPECT_NEAR(packet.azimuth_cdeg[static_cast<size_t>(block)], truth, 1e-9) << "block " << block;
    }
}

TEST(Vlp16PacketTest, RepairsARunOfAzimuthsAndBothOfADualPair) {
  PacketBytes bytes = packetAt(1000);
  for (const int block : {3, 4, 5}) test::setAzimuth(bytes, block, 40000);
  PacketBytes dual = packetAt(1000, 0x39, 0x22, true);
  for (const int block : {4, 5}) test::setAzimuth(dual, block, 40000);
  Vlp16Packet packet;
  ASSERT_EQ(parsePacket(bytes, packet), PacketFault::kNone);
  for (const int block : {3, 4, 5})
    EXPECT_NEAR(packet.azimuth_cdeg[static_cast<size_t>(block)], 1000 + 40.0 * block, 1e-9);
  ASSERT_EQ(parsePacket(dual, packet), PacketFault::kNone);
  for (const int block : {4, 5}) EXPECT_NEAR(packet.azimuth_cdeg[static_cast<size_t>(block)], 1080, 1e-9);
}

TEST(Vlp16PacketTest, WithoutTwoValidAzimuthsThePacketIsRefused) {
  PacketBytes bytes = packetAt(1000);
  for (int block = 1; block < 12; ++block) test::setAzimuth(bytes, block, 36001);
  Vlp16Packet packet;
  EXPECT_EQ(parsePacket(bytes, packet), PacketFault::kNoAzimuth);
}

}  // namespace
}  // namespace sgraphs
