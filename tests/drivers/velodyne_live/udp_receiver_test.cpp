// Over real sockets on the loopback interface, on ports that the kernel chooses.
#include "drivers/velodyne_live/udp_receiver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "common/base/error.h"
#include "common/base/performance.h"
#include "drivers/host_clock.h"
#include "drivers/recording/pcap_reader.h"
#include "drivers/velodyne_live/live_packets.h"
#include "drivers/velodyne_live/udp_sender.h"
#include "tests/common/test_files.h"

namespace sgraphs {
namespace {

using testing::HasSubstr;

constexpr uint32_t kLoopback = 0x7F000001;
const std::string kCapture = SGRAPHS_SHARED_DATA_DIR "/vlp16/veloview_vlp-16-test-90deg-1-50-frames.pcap";

UdpOptions loopback() {
  UdpOptions options;
  options.ports = {0, 0};
  options.bind_address = "127.0.0.1";
  return options;
}

// What arrives, until so many have or nothing does for 5 s.
std::vector<UdpDatagram> receive(UdpReceiver& receiver, size_t count) {
  std::vector<UdpDatagram> all;
  while (all.size() < count) {
    const auto some = receiver.take(5000);
    if (some.empty()) break;
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

TEST(UdpReceiverTest, DatagramsArriveInOrderWithPortSourceAndTime) {
  UdpReceiver receiver(loopback());
  ASSERT_EQ(receiver.ports().size(), 2u);
  UdpSender sender(kLoopback);
  const Time before = hostClock();
  for (uint8_t i = 0; i < 200; ++i)
    sender.send(receiver.ports()[i % 2], std::vector<uint8_t>(static_cast<size_t>(i), i));
  const std::vector<UdpDatagram> all = receive(receiver, 200);
  const Time after = hostClock();
  ASSERT_EQ(all.size(), 200u);
  std::map<uint16_t, int> newest;
  for (const UdpDatagram& d : all) {
    EXPECT_EQ(d.source_address, kLoopback);
    EXPECT_GE(d.captured, before);
    EXPECT_LE(d.captured, after);
    const auto i = static_cast<int>(d.payload.size());
    EXPECT_EQ(d.destination_port, receiver.ports()[static_cast<size_t>(i % 2)]);
    EXPECT_EQ(d.payload, std::vector<uint8_t>(d.payload.size(), static_cast<uint8_t>(i)));
    EXPECT_GE(i, newest[d.destination_port]);
    newest[d.destination_port] = i;
  }
  EXPECT_EQ(receiver.health().dropped_by_kernel + receiver.health().dropped_by_queue, 0);
}

TEST(UdpReceiverTest, ARealCaptureOverTheNetworkIsTheCapture) {
  if (!std::filesystem::exists(kCapture)) GTEST_SKIP() << "shared data absent: " << kCapture;
  UdpReceiver receiver(loopback());
  VelodyneDriverConfig config;
  config.stamps = "device";
  LivePackets live(config, receiver.ports()[0], receiver.ports()[1]), direct(config, 2368, 8308);
  PcapReader reader(kCapture);
  UdpSender sender(kLoopback);
  std::vector<PacketGroup> over_network, expected;
  while (const auto datagram = reader.next()) {
    if (const auto group = direct.step(*datagram)) expected.push_back(*group);
    const bool data = datagram->destination_port == 2368;
    sender.send(receiver.ports()[data ? 0 : 1], datagram->payload);
    // One at a time: whether a burst fits is the kernel's affair.
    for (const UdpDatagram& arrived : receive(receiver, 1))
      if (const auto group = live.step(arrived)) over_network.push_back(*group);
  }
  EXPECT_EQ(live.counts().accepted, direct.counts().accepted);
  EXPECT_EQ(live.counts().position, 367);
  EXPECT_EQ(live.counts().lost, direct.counts().lost);
  ASSERT_EQ(over_network.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    ASSERT_EQ(over_network[i].packets.size(), expected[i].packets.size());
    EXPECT_EQ(over_network[i].revolution, expected[i].revolution);
    EXPECT_EQ(over_network[i].part, expected[i].part);
    EXPECT_EQ(over_network[i].last_part, expected[i].last_part);
    for (size_t k = 0; k < expected[i].packets.size(); ++k)
      EXPECT_EQ(over_network[i].packets[k].bytes, expected[i].packets[k].bytes);
  }
}

TEST(UdpReceiverTest, SilenceReturnsEmptyHanded) {
  UdpReceiver receiver(loopback());
  EXPECT_TRUE(receiver.take(20).empty());
  EXPECT_FALSE(receiver.ended());
}

TEST(UdpReceiverTest, AFullQueueDropsTheNewestAndCounts) {
  UdpReceiver receiver(loopback());
  UdpSender sender(kLoopback);
  const size_t sent = UdpReceiver::kMaxWaiting + 500;
  size_t i = 0;
  for (; i < sent; ++i) {
    sender.send(receiver.ports()[0],
                std::vector<uint8_t>{static_cast<uint8_t>(i), static_cast<uint8_t>(i >> 8)});
    // Let the thread keep up: the kernel's buffer is not what is tested here.
    while (receiver.health().waiting + static_cast<size_t>(receiver.health().dropped_by_queue) +
               static_cast<size_t>(receiver.health().dropped_by_kernel) <
           i) {
    }
  }
  const Stopwatch patience;
  while (receiver.health().dropped_by_queue < 500 && patience.elapsedSeconds() < 10) {
  }
  EXPECT_EQ(receiver.health().dropped_by_queue, 500);
  const auto all = receive(receiver, UdpReceiver::kMaxWaiting);
  ASSERT_EQ(all.size(), UdpReceiver::kMaxWaiting);
  for (size_t k = 0; k < all.size(); ++k)
    ASSERT_EQ(all[k].payload[0] | all[k].payload[1] << 8, static_cast<int>(k));
}

TEST(UdpReceiverTest, TwoProgramsMayListenOnOnePort) {
  UdpOptions options = loopback();
  options.ports = {0};
  UdpReceiver first(options);
  options.ports = {first.ports()[0]};
  EXPECT_NO_THROW(UdpReceiver second(options));
}

TEST(UdpReceiverTest, WhatCannotBeHadIsSaidInOneLine) {
  UdpOptions options = loopback();
  options.bind_address = "203.0.113.1";
  EXPECT_THAT(test::messageOf<Error>([&] { UdpReceiver receiver(options); }),
              HasSubstr("cannot listen on UDP port"));
  options.bind_address = "nowhere";
  EXPECT_THAT(test::messageOf<UsageError>([&] { UdpReceiver receiver(options); }),
              HasSubstr("bind_address 'nowhere'"));
  options.bind_address = "127.0.0.1";
  options.multicast_group = "10.0.0.1";
  EXPECT_THAT(test::messageOf<Error>([&] { UdpReceiver receiver(options); }), HasSubstr("cannot join group"));
}

TEST(UdpReceiverTest, AGroupIsHeardWhereItIsJoined) {
  UdpOptions options = loopback();
  options.ports = {0};
  options.multicast_group = "239.255.76.70";
  UdpReceiver receiver(options);
  // Unicast to the same port still arrives; whether this machine routes groups is not known here.
  UdpSender sender(kLoopback);
  sender.send(receiver.ports()[0], std::vector<uint8_t>{1});
  EXPECT_EQ(receive(receiver, 1).size(), 1u);
}

}  // namespace
}  // namespace sgraphs
