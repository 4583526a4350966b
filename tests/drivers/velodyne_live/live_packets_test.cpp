#include "drivers/velodyne_live/live_packets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.h"
#include "tests/common/test_files.h"
#include "tests/drivers/velodyne_live/sensor_stream.h"

namespace sgraphs {
namespace {

using test::SensorStream;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

VelodyneDriverConfig deviceTime() {
  VelodyneDriverConfig config;
  config.stamps = "device";
  return config;
}

LivePackets makePackets(const VelodyneDriverConfig& config = deviceTime()) {
  return {config, SensorStream::kDataPort, SensorStream::kPositionPort};
}

int64_t rejected(const LivePackets& packets, PacketFault fault) {
  return packets.counts().rejected[static_cast<size_t>(fault)];
}

// Packets that come out of so many.
int feed(LivePackets& packets, SensorStream& stream, int count) {
  int out = 0;
  for (int i = 0; i < count; ++i)
    if (const auto group = packets.step(stream.next())) out += static_cast<int>(group->packets.size());
  return out;
}

TEST(LivePacketsTest, EveryPacketComesOutOnceInOrderWithItsTime) {
  LivePackets packets = makePackets();
  SensorStream stream, truth;
  std::vector<VelodynePacket> out;
  for (int i = 0; i < 500; ++i)
    if (const auto group = packets.step(stream.next()))
      out.insert(out.end(), group->packets.begin(), group->packets.end());
  if (const auto group = packets.flush()) out.insert(out.end(), group->packets.begin(), group->packets.end());
  ASSERT_EQ(out.size(), 500u);
  for (const VelodynePacket& packet : out) {
    const int64_t time_us = SensorStream::kHour_us + truth.sensor.timeUs();
    EXPECT_NEAR(static_cast<double>(packet.time.us - time_us), 0.0, 1.0);
    EXPECT_EQ(packet.bytes, truth.sensor.next());
  }
  EXPECT_EQ(packets.counts().lost, 0);
  EXPECT_THAT(packets.takeNotices(), IsEmpty());
}

TEST(LivePacketsTest, TheCutAngleMovesTheEndsOfRevolutions) {
  for (const double cut_deg : {0.0, 90.0, 270.0}) {
    VelodyneDriverConfig config = deviceTime();
    config.cut_azimuth_deg = cut_deg;
    LivePackets packets = makePackets(config);
    SensorStream stream;
    int revolutions = 0;
    for (int i = 0; i < 800; ++i) {
      const auto group = packets.step(stream.next());
      if (!group || !group->last_part) continue;
      ++revolutions;
      const auto& last = group->packets.back().bytes;
      const double first_deg = 0.01 * rawAzimuth_cdeg(last, 0);
      const double to_cut_deg = std::remainder(cut_deg - first_deg, 360.0);
      EXPECT_GT(to_cut_deg, -0.41) << "the cut may lie just before the packet's first block";
      EXPECT_LT(to_cut_deg, 4.8) << "a packet spans 4.8 degrees";
    }
    EXPECT_GE(revolutions, 9) << cut_deg;
  }
}

TEST(LivePacketsTest, LostPacketsAreCountedByTheStamps) {
  LivePackets packets = makePackets();
  SensorStream stream;
  feed(packets, stream, 100);
  stream.sensor.skip(3);
  feed(packets, stream, 100);
  EXPECT_EQ(packets.counts().lost, 3);
  EXPECT_EQ(packets.counts().accepted, 200);
}

TEST(LivePacketsTest, GarbageIsCountedNamedOnceInAWhileAndSurvived) {
  LivePackets packets = makePackets();
  SensorStream stream;
  for (int i = 0; i < 150; ++i) {
    feed(packets, stream, 1);
    packets.step(stream.datagram(std::vector<uint8_t>(static_cast<size_t>(i), 0xFF)));
    packets.step(stream.datagram(std::vector<uint8_t>(1206, static_cast<uint8_t>(i))));
    packets.step(stream.datagram({}, SensorStream::kPositionPort));
  }
  EXPECT_EQ(packets.counts().accepted, 150);
  EXPECT_EQ(packets.counts().lost, 0);
  EXPECT_EQ(rejected(packets, PacketFault::kWrongSize), 150);
  EXPECT_EQ(rejected(packets, PacketFault::kWrongBlockFlag), 150);
  const std::vector<std::string> notices = packets.takeNotices();
  EXPECT_EQ(notices.size(), 9u) << "three kinds, the 1st, 10th and 100th time";
  EXPECT_THAT(notices, Contains(AllOf(HasSubstr("192.168.1.201"), HasSubstr("not 1206 bytes but 0"))));
}

// Garbage that comes first must not pass for the sensor.
TEST(LivePacketsTest, OnlyAPacketThatFitsMakesItsSourceTheSensor) {
  LivePackets packets = makePackets();
  SensorStream noise(7), stream;
  packets.step(noise.datagram(std::vector<uint8_t>(1206)));
  feed(packets, stream, 100);
  EXPECT_EQ(packets.counts().accepted, 100);
  EXPECT_EQ(packets.counts().other_sensor, 0);
}

TEST(LivePacketsTest, TheFirstOfTwoSensorsIsKeptAndTheSecondNamed) {
  LivePackets packets = makePackets();
  SensorStream first(201), second(202);
  second.sensor.azimuth_cdeg = 18000;
  for (int i = 0; i < 300; ++i) {
    feed(packets, first, 1);
    packets.step(second.next());
  }
  EXPECT_EQ(packets.counts().accepted, 300);
  EXPECT_EQ(packets.counts().other_sensor, 300);
  EXPECT_EQ(packets.counts().lost, 0);
  const auto notices = packets.takeNotices();
  EXPECT_EQ(notices.size(), 3u);
  EXPECT_THAT(notices.front(), AllOf(HasSubstr("192.168.1.202"), HasSubstr("192.168.1.201")));
}

TEST(LivePacketsTest, TheSourceFilterChoosesTheSensor) {
  VelodyneDriverConfig config = deviceTime();
  config.source_address = "192.168.1.202";
  LivePackets packets = makePackets(config);
  SensorStream first(201), second(202);
  for (int i = 0; i < 100; ++i) {
    packets.step(first.next());
    packets.step(second.next());
  }
  EXPECT_EQ(packets.counts().accepted, 100);
  EXPECT_EQ(packets.counts().other_sensor, 100);
  config.source_address = "192.168.1.2020";
  EXPECT_THAT(test::messageOf<UsageError>([&] { makePackets(config); }),
              HasSubstr("source_address '192.168.1.2020'"));
}

TEST(LivePacketsTest, AReplacedSensorIsTakenAfterTenSecondsOfSilence) {
  LivePackets packets = makePackets();
  SensorStream first(201), second(202);
  feed(packets, first, 100);
  second.sensor.time_us = first.sensor.time_us + 5e6;
  feed(packets, second, 1);
  EXPECT_EQ(packets.counts().other_sensor, 1);
  second.sensor.time_us += 6e6;
  feed(packets, second, 100);
  EXPECT_EQ(packets.counts().accepted, 200);
  EXPECT_EQ(packets.counts().other_sensor, 1);
}

TEST(LivePacketsTest, AThirtyTwoBeamSensorIsRefusedAndNamed) {
  LivePackets packets = makePackets();
  SensorStream stream;
  UdpDatagram datagram = stream.next();
  for (int i = 0; i < 1000; ++i) {
    test::PacketBytes bytes = test::makePacket(
        0, 20, static_cast<uint32_t>(553 * i), false, [](int, int, int) { return uint16_t{1}; }, 0x37, 0x21);
    datagram.payload.assign(bytes.begin(), bytes.end());
    datagram.captured = Time{SensorStream::kHour_us + 553 * i};
    packets.step(datagram);
  }
  EXPECT_TRUE(packets.thirtyTwoBeams());
  EXPECT_GT(rejected(packets, PacketFault::kThirtyTwoBeams), 990);
  EXPECT_THAT(packets.takeNotices(), Contains(HasSubstr("192.168.1.201 is a 32-beam sensor")));
}

TEST(LivePacketsTest, RepeatedAndOvertakenPacketsAreRefused) {
  LivePackets packets = makePackets();
  SensorStream stream;
  feed(packets, stream, 50);
  const UdpDatagram a = stream.next(), b = stream.next();
  packets.step(b);
  packets.step(b);
  packets.step(a);
  feed(packets, stream, 50);
  EXPECT_EQ(packets.counts().accepted, 101);
  EXPECT_EQ(rejected(packets, PacketFault::kOutOfOrder), 2);
  EXPECT_EQ(packets.counts().lost, 1);
}

TEST(LivePacketsTest, ASensorThatRestartsIsCarriedOnAndNoted) {
  LivePackets packets = makePackets(VelodyneDriverConfig{});
  SensorStream stream;
  stream.sensor.time_us = 1000e6;
  feed(packets, stream, 100);
  std::vector<VelodynePacket> out;
  for (int i = 0; i < 100; ++i) {
    UdpDatagram datagram = stream.next();
    test::PacketBytes bytes;
    std::copy(datagram.payload.begin(), datagram.payload.end(), bytes.begin());
    test::setStamp(bytes, static_cast<uint32_t>(1327 * i));
    datagram.payload.assign(bytes.begin(), bytes.end());
    if (const auto group = packets.step(datagram))
      out.insert(out.end(), group->packets.begin(), group->packets.end());
  }
  EXPECT_EQ(packets.counts().accepted, 199);
  EXPECT_EQ(rejected(packets, PacketFault::kStrayStamp), 1);
  for (size_t i = 1; i < out.size(); ++i) EXPECT_GT(out[i].time, out[i - 1].time);
  EXPECT_THAT(packets.takeNotices(), Contains(HasSubstr("clock was set anew")));
}

TEST(LivePacketsTest, PositionPacketsTellOfTheReceiver) {
  LivePackets packets = makePackets();
  SensorStream stream, other(202);
  feed(packets, stream, 10);
  std::vector<uint8_t> position(512);
  position[202] = 2;
  packets.step(stream.datagram(position, SensorStream::kPositionPort));
  ASSERT_TRUE(packets.position());
  EXPECT_EQ(packets.position()->pps, PpsState::kLocked);
  position[202] = 3;
  packets.step(other.datagram(position, SensorStream::kPositionPort));
  EXPECT_EQ(packets.position()->pps, PpsState::kLocked);
  packets.step(stream.datagram({1, 2, 3}, 1234));
  EXPECT_EQ(packets.counts().other_datagrams, 1);
}

TEST(LivePacketsTest, AddressesGoThroughText) {
  EXPECT_EQ(parseAddress("192.168.1.201", "--x"), 0xC0A801C9u);
  EXPECT_EQ(toString(0xC0A801C9u), "192.168.1.201");
  EXPECT_THROW(parseAddress("sensor", "--x"), UsageError);
}

}  // namespace
}  // namespace sgraphs
