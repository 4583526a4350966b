#include "common/bus/log_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.h"
#include "tests/common/test_files.h"

namespace sgraphs {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<uint8_t> payload(int i) {
  return std::vector<uint8_t>(static_cast<size_t>(i), static_cast<uint8_t>(i));
}

// Three events of 28 + 1 bytes and a payload of 3, 4 and 5 bytes.
fs::path threeEvents() {
  fs::path path = test::freshFolder() / "three.lcmlog";
  LogWriter log(path);
  for (int i = 3; i < 6; ++i) log.write(1000 * i, "C", payload(i));
  log.close();
  return path;
}

std::vector<size_t> payloadSizes(LogReader& reader) {
  std::vector<size_t> sizes;
  while (const auto event = reader.next()) sizes.push_back(event->bytes.size());
  return sizes;
}

TEST(LogFileTest, ReadsBackWhatWasWritten) {
  LogReader reader(threeEvents());
  for (int i = 3; i < 6; ++i) {
    const auto event = reader.next();
    ASSERT_TRUE(event);
    EXPECT_EQ(event->number, i - 3);
    EXPECT_EQ(event->timestamp_us, 1000 * i);
    EXPECT_EQ(event->channel, "C");
    EXPECT_EQ(event->bytes, payload(i));
  }
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.truncated());
  EXPECT_EQ(reader.skippedBytes(), 0);
  EXPECT_EQ(reader.position(), reader.fileBytes());
}

TEST(LogFileTest, TheBytesAreLcms) {
  // Sync word, event number, time stamp, lengths: big-endian (lcm/eventlog.c documents the format).
  const fs::path path = test::freshFolder() / "one.lcmlog";
  LogWriter log(path);
  log.write(0x0102030405060708, "AB", std::vector<uint8_t>{9});
  log.close();
  EXPECT_THAT(test::readBytes(path), ElementsAre(0xED, 0xA1, 0xDA, 0x01, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4,
                                                 5, 6, 7, 8, 0, 0, 0, 2, 0, 0, 0, 1, 'A', 'B', 9));
}

TEST(LogFileTest, ACutEventIsToldWhereverTheCutIs) {
  const fs::path path = threeEvents();
  const std::vector<uint8_t> whole = test::readBytes(path);
  const size_t last = 29 + 5;  // bytes of the last event
  for (size_t cut = 1; cut < last; ++cut) {
    test::writeBytes(path, {whole.begin(), whole.end() - static_cast<std::ptrdiff_t>(cut)});
    LogReader reader(path);
    EXPECT_THAT(payloadSizes(reader), ElementsAre(3, 4)) << cut << " bytes cut";
    EXPECT_TRUE(reader.truncated()) << cut << " bytes cut";
  }
}

TEST(LogFileTest, ForeignBytesBetweenEventsAreSkippedAndCounted) {
  const fs::path path = threeEvents();
  std::vector<uint8_t> bytes = test::readBytes(path);
  const std::vector<uint8_t> garbage{1, 2, 0xED, 0xA1, 3, 4, 5};
  bytes.insert(bytes.begin() + 29 + 3, garbage.begin(), garbage.end());
  test::writeBytes(path, bytes);
  LogReader reader(path);
  EXPECT_THAT(payloadSizes(reader), ElementsAre(3, 4, 5));
  EXPECT_EQ(reader.skippedBytes(), 7);
  EXPECT_FALSE(reader.truncated());
}

TEST(LogFileTest, ASyncWordWithinGarbageIsNoEvent) {
  const fs::path path = threeEvents();
  std::vector<uint8_t> bytes = test::readBytes(path);
  std::vector<uint8_t> garbage{0xED, 0xA1, 0xDA, 0x01};
  garbage.resize(40, 0xFF);  // a channel name of 4 GB
  bytes.insert(bytes.begin() + 29 + 3, garbage.begin(), garbage.end());
  test::writeBytes(path, bytes);
  LogReader reader(path);
  EXPECT_THAT(payloadSizes(reader), ElementsAre(3, 4, 5));
  EXPECT_EQ(reader.skippedBytes(), 40);
}

TEST(LogFileTest, WhatIsNoLogIsRefusedInOneLine) {
  const fs::path folder = test::freshFolder();
  test::writeText(folder / "empty", "");
  test::writeText(folder / "text", "this is no log, whatever its name");
  EXPECT_THAT(test::messageOf<Error>([&] { LogReader(folder / "missing"); }), HasSubstr("missing"));
  EXPECT_THAT(test::messageOf<Error>([&] { LogReader(folder / "empty"); }), HasSubstr("is empty"));
  EXPECT_THAT(test::messageOf<Error>([&] { LogReader(folder / "text"); }), HasSubstr("not an LCM log"));
  EXPECT_THAT(test::messageOf<Error>([&] { LogWriter(folder / "no" / "folder"); }),
              HasSubstr("cannot create"));
}

TEST(LogFileTest, AForeignLogIsReadWhole) {
  const std::string path = std::string(SGRAPHS_SHARED_DATA_DIR) + "/lcm/umich_maebot_convex.lcmlog";
  if (!fs::exists(path)) GTEST_SKIP() << "shared data absent: lcm/umich_maebot_convex.lcmlog";
  LogReader reader(path);
  EXPECT_EQ(payloadSizes(reader).size(), 5714u);
  EXPECT_FALSE(reader.truncated());
  EXPECT_EQ(reader.skippedBytes(), 0);
}

TEST(LogBusTest, DeliversEventsOneByOneAndRecordsWhatIsPublished) {
  const fs::path input = threeEvents();
  const fs::path output = input.string() + ".out";
  LogWriter writer(output);
  LogBus bus(input, &writer);
  std::vector<size_t> sizes;
  bus.subscribe("C", [&](Bus::Bytes bytes) {
    sizes.push_back(bytes.size());
    bus.publish("D", bytes);
  });
  bus.subscribe("X", [&](Bus::Bytes) { FAIL() << "no event of this channel"; });
  EXPECT_TRUE(bus.dispatch(0));
  EXPECT_THAT(sizes, ElementsAre(3));
  while (bus.dispatch(0)) {
  }
  writer.close();
  LogReader reader(output);
  const auto first = reader.next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->channel, "D");
  EXPECT_EQ(first->timestamp_us, 3000);
  EXPECT_THAT(payloadSizes(reader), ElementsAre(4, 5));
}

}  // namespace
}  // namespace sgraphs
