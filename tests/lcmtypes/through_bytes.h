#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "common/bus/bus.h"

namespace sgraphs::test {

// The message as its receiver gets it.
template <typename Message>
Message throughBytes(const Message& message) {
  std::vector<uint8_t> bytes(static_cast<size_t>(message.getEncodedSize()));
  EXPECT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  Message received{};
  EXPECT_TRUE(decode(bytes, received));
  return received;
}

template <typename Message>
std::vector<Message> throughBytes(const std::vector<Message>& messages) {
  std::vector<Message> received;
  for (const Message& message : messages) received.push_back(throughBytes(message));
  return received;
}

}  // namespace sgraphs::test
