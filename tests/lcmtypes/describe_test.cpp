// Messages are shown by what their .lcm files say, not by generated code: the two have to agree.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>

#include "common/bus/channels.h"
#include "lcmtypes/describe/message_text.h"

namespace sgraphs {
namespace {

using testing::HasSubstr;

std::string textOf(std::span<const uint8_t> bytes, size_t max_elements = 8) {
  return messageText(TypeCatalogue::ours(), bytes, max_elements).value_or("(none)");
}

TEST(DescribeTest, EveryFingerprintIsTheOneThatIsLocked) {
  std::ifstream in(std::filesystem::path(SGRAPHS_SOURCE_DIR) / "lcmtypes" / "fingerprints.txt");
  std::string name, hash;
  int types = 0;
  std::set<int64_t> seen;
  for (; in >> name >> hash; ++types) {
    ASSERT_TRUE(TypeCatalogue::ours().find(name)) << name;
    char text[17];
    const int64_t fingerprint = TypeCatalogue::ours().fingerprintOf(name);
    std::snprintf(text, sizeof text, "%016" PRIx64, static_cast<uint64_t>(fingerprint));
    EXPECT_EQ(text, hash) << name;
    EXPECT_TRUE(seen.insert(fingerprint).second) << name << " has the members of another type";
  }
  EXPECT_GT(types, 20);
}

TEST(DescribeTest, TheTypeOfEveryChannelIsDescribed) {
  for (const channels::Row& row : channels::table())
    EXPECT_TRUE(TypeCatalogue::ours().find(row.type)) << row.name;
}

TEST(DescribeTest, AMessageReadsMemberByMember) {
  stream_end_t message{};
  message.header.session = 123456789012345;
  message.header.seq = -2;
  message.header.utime = 1'700'000'000'000'001;
  message.why_not = "2 messages of SPOT_ODOMETRY lost";
  message.num_channels = 2;
  message.channel = {"SESSION", "VELODYNE_PACKETS"};
  message.last_seq = {5, -1};
  EXPECT_EQ(textOf(encoded(message)),
            "header:\n"
            "  session: 123456789012345\n"
            "  boot: 0\n"
            "  seq: -2\n"
            "  utime: 1700000000000001\n"
            "why_not: \"2 messages of SPOT_ODOMETRY lost\"\n"
            "num_channels: 2\n"
            "channel[2]: [\"SESSION\", \"VELODYNE_PACKETS\"]\n"
            "last_seq[2]: [5, -1]\n");
}

TEST(DescribeTest, ArraysOfStructsAndOfRowsAreShownAsFarAsAsked) {
  keyframe_planes_t message{};
  message.num_planes = 3;
  for (int i = 0; i < 3; ++i) {
    plane_t plane{};
    plane.normal[0] = 0.5;
    plane.rms_m = 0.125f * static_cast<float>(i);
    plane.num_corners = 3;
    plane.boundary = {{0, 1}, {2, 3}, {-4.5f, 5}};
    message.planes.push_back(plane);
  }
  const std::string text = textOf(encoded(message), 2);
  EXPECT_THAT(text, HasSubstr("planes[3]:\n  [0]:\n    normal[3]: [0.5, 0, … 1 more]\n"));
  EXPECT_THAT(text, HasSubstr("    rms_m: 0.125\n"));
  EXPECT_THAT(text, HasSubstr("    boundary[3][2]: [[0, 1], [2, 3], … 1 more]\n"));
  EXPECT_THAT(text, HasSubstr("  … 1 more\n"));
  EXPECT_THAT(textOf(encoded(message), 8), HasSubstr("[-4.5, 5]]"));
}

TEST(DescribeTest, BytesAreShownInHexadecimal) {
  keyframe_t message{};
  message.num_bytes = 10;
  message.points = {0, 1, 255, 3, 4, 5, 6, 7, 8, 9};
  EXPECT_THAT(textOf(encoded(message), 3), HasSubstr("points[10]: 00 01 ff … 7 more bytes\n"));
}

TEST(DescribeTest, WhatIsNotExactlyOneMessageIsRefused) {
  stream_end_t message{};
  message.why_not = "x";
  message.num_channels = 1;
  message.channel = {"SESSION"};
  message.last_seq = {1};
  std::vector<uint8_t> bytes = encoded(message);
  const TypeCatalogue& ours = TypeCatalogue::ours();
  EXPECT_TRUE(isWholeMessage(ours, bytes));
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(isWholeMessage(ours, std::span(bytes).first(size))) << size;
  // Any byte spoiled: read or refused, but nothing is read that is not there.
  for (size_t i = 0; i < bytes.size(); ++i)
    for (const int value : {0x00, 0x7F, 0xFF}) {
      std::vector<uint8_t> spoiled = bytes;
      spoiled[i] = static_cast<uint8_t>(value);
      isWholeMessage(ours, spoiled);
    }
  bytes.push_back(0);
  EXPECT_FALSE(isWholeMessage(ours, bytes));
}

TEST(DescribeTest, CommentsAndConstantsOfAFileAreNoMembers) {
  const TypeDescription type = parseLcm(
      "package p; // a ; b\nstruct a_t {\n  /* int8_t no; */ const int32_t A = 1, B = 2;\n  p.b_t "
      "c[2][n];\n}");
  EXPECT_EQ(type.name, "a_t");
  ASSERT_EQ(type.members.size(), 1u);
  EXPECT_EQ(type.members[0].type, "b_t");
  ASSERT_EQ(type.members[0].dimensions.size(), 2u);
  EXPECT_EQ(type.members[0].dimensions[0].size, 2);
  EXPECT_EQ(type.members[0].dimensions[1].member, "n");
  EXPECT_THROW(parseLcm("package p; struct a_t { int8_t x"), std::logic_error);
}

}  // namespace
}  // namespace sgraphs
