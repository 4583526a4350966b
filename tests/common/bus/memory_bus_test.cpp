#include "common/bus/memory_bus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "common/bus/channels.h"

namespace sgraphs {
namespace {

using testing::ElementsAre;

std::vector<uint8_t> bytesOf(uint8_t value) {
  return {value};
}

TEST(MemoryBusTest, WhatAHandlerPublishesComesAfterWhatIsQueued) {
  MemoryBus bus;
  std::vector<std::string> order;
  bus.subscribe("A", [&](Bus::Bytes bytes) {
    order.push_back("A" + std::to_string(bytes[0]));
    bus.publish("B", bytes);
  });
  bus.subscribe("B", [&](Bus::Bytes bytes) { order.push_back("B" + std::to_string(bytes[0])); });
  bus.publish("A", bytesOf(1));
  bus.publish("A", bytesOf(2));
  EXPECT_TRUE(bus.dispatch(0));
  EXPECT_THAT(order, ElementsAre("A1", "A2", "B1", "B2"));
  EXPECT_FALSE(bus.dispatch(0));
}

TEST(MemoryBusTest, EverySubscriberIsCalledInOrderOfSubscription) {
  MemoryBus bus;
  std::vector<int> calls;
  for (int i = 0; i < 3; ++i) bus.subscribe("A", [&calls, i](Bus::Bytes) { calls.push_back(i); });
  bus.publish("A", bytesOf(0));
  bus.dispatch(0);
  EXPECT_THAT(calls, ElementsAre(0, 1, 2));
}

TEST(MemoryBusTest, ChannelsAreNamesAndNoPatterns) {
  MemoryBus bus;
  int calls = 0;
  bus.subscribe("POSE", [&](Bus::Bytes) { ++calls; });
  bus.publish("POSE_ODOM", bytesOf(0));
  bus.publish("MY_POSE", bytesOf(0));
  bus.dispatch(0);
  EXPECT_EQ(calls, 0);
}

TEST(MemoryBusTest, AHandlersErrorReachesTheCaller) {
  MemoryBus bus;
  bus.subscribe("A", [](Bus::Bytes) { throw std::runtime_error("broken"); });
  bus.publish("A", bytesOf(0));
  EXPECT_THROW(bus.dispatch(0), std::runtime_error);
}

TEST(MemoryBusTest, TypedMessagesTravelAsBytesAndForeignOnesAreTold) {
  MemoryBus bus;
  int undecodable = 0;
  std::vector<int64_t> rounds;
  subscribe(
      bus, channels::kRunResult, [&](const run_result_t& m) { rounds.push_back(m.rounds); },
      [&] { ++undecodable; });
  run_result_t message{};
  message.rounds = 42;
  publish(bus, channels::kRunResult, message);
  bus.publish("RUN_RESULT", bytesOf(7));
  stream_end_t other{};
  publish(bus, Channel<stream_end_t>{"RUN_RESULT"}, other);
  bus.dispatch(0);
  EXPECT_THAT(rounds, ElementsAre(42));
  EXPECT_EQ(undecodable, 2);
}

TEST(BusTest, AnImpossibleCountIsUndecodable) {
  session_t message{}, decoded{};
  std::vector<uint8_t> bytes(static_cast<size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  ASSERT_TRUE(decode(bytes, decoded));
  // num_stages stands behind fingerprint, header (4 * 8), schema (4) and the empty writer (4 + 1).
  const size_t num_stages = 8 + 32 + 4 + 5;
  for (size_t i = 0; i < 4; ++i) bytes[num_stages + i] = 0xFF;
  EXPECT_FALSE(decode(bytes, decoded));
}

TEST(BusTest, BytesBehindAMessageMakeItUndecodable) {
  run_result_t message{}, decoded{};
  std::vector<uint8_t> bytes(static_cast<size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  EXPECT_TRUE(decode(bytes, decoded));
  bytes.push_back(0);
  EXPECT_FALSE(decode(bytes, decoded));
}

}  // namespace
}  // namespace sgraphs
