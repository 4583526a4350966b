#include "drivers/velodyne/position_packet.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

namespace sgraphs {
namespace {

std::string withChecksum(const std::string& body) {
  int sum = 0;
  for (const char c : body) sum ^= c;
  char text[8];
  std::snprintf(text, sizeof text, "*%02X", sum);
  return "$" + body + text;
}

std::vector<uint8_t> packetWith(const std::string& sentence, uint8_t pps) {
  std::vector<uint8_t> bytes(512);
  const uint32_t stamp = 1234567890;
  for (size_t i = 0; i < 4; ++i) bytes[198 + i] = static_cast<uint8_t>(stamp >> (8 * i));
  bytes[202] = pps;
  const std::string line = sentence + "\r\n";
  std::copy(line.begin(), line.end(), bytes.begin() + 206);
  return bytes;
}

const std::string kBody = "GPRMC,183015,A,3725.2315,N,12158.6214,W,000.0,000.0,021114,013.2,E";

TEST(PositionPacketTest, ReadsSentencePulseAndStamp) {
  const auto packet = parsePositionPacket(packetWith(withChecksum(kBody), 2));
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->stamp_us, 1234567890u);
  EXPECT_EQ(packet->pps, PpsState::kLocked);
  EXPECT_TRUE(packet->fix);
  ASSERT_TRUE(packet->utc);
  EXPECT_EQ(packet->utc->us, 1'414'953'015'000'000);  // date -u -d '2014-11-02 18:30:15' +%s
  EXPECT_EQ(packet->sentence, withChecksum(kBody));
}

TEST(PositionPacketTest, AReceiverWithoutFixOrDateIsNoTime) {
  const auto packet = parsePositionPacket(packetWith(withChecksum("GPRMC,183015,V,,,,,,,,,,N"), 1));
  ASSERT_TRUE(packet);
  EXPECT_FALSE(packet->fix);
  EXPECT_FALSE(packet->utc);
  EXPECT_EQ(packet->pps, PpsState::kSynchronising);
}

TEST(PositionPacketTest, ASpoiledSentenceIsNotBelieved) {
  std::string sentence = withChecksum(kBody);
  sentence[10] = '7';
  const auto packet = parsePositionPacket(packetWith(sentence, 0));
  ASSERT_TRUE(packet);
  EXPECT_FALSE(packet->fix);
  EXPECT_FALSE(packet->utc);
}

TEST(PositionPacketTest, DatesThatCannotBeAreNoTime) {
  for (const char* body : {"GPRMC,183015,A,,,,,,,310214,,", "GPRMC,253015,A,,,,,,,021114,,",
                           "GPRMC,18x015,A,,,,,,,021114,,", "GPRMC,1,A,,,,,,,0,,"}) {
    const auto packet = parsePositionPacket(packetWith(withChecksum(body), 0));
    ASSERT_TRUE(packet);
    EXPECT_FALSE(packet->utc) << body;
  }
}

TEST(PositionPacketTest, WhatIsNoPositionPacketIsRefused) {
  EXPECT_FALSE(parsePositionPacket(std::vector<uint8_t>(511)));
  EXPECT_FALSE(parsePositionPacket(packetWith("", 4)));
  const auto silent = parsePositionPacket(std::vector<uint8_t>(512));
  ASSERT_TRUE(silent);
  EXPECT_EQ(silent->sentence, "");
}

// A sentence without its end must not be read past the packet's.
TEST(PositionPacketTest, ASentenceMayFillThePacket) {
  std::vector<uint8_t> bytes(512, 'A');
  bytes[202] = 0;
  const std::string begin = "$GPRMC,";
  std::copy(begin.begin(), begin.end(), bytes.begin() + 206);
  const auto packet = parsePositionPacket(bytes);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->sentence.size(), 306u);
  EXPECT_FALSE(packet->utc);
}

}  // namespace
}  // namespace sgraphs
