#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "common/bus/bus.h"

namespace sgraphs::test {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr int kDatagramBytes = 60'000;  // that a message must fit into

// The message as its receiver gets it.
template <typename Message>
Message throughBytes(const Message& message) {
  const std::vector<uint8_t> bytes = encoded(message);
  Message received{};
  EXPECT_TRUE(decode(bytes, received));
  return received;
}

template <typename Message>
std::vector<Message> throughBytes(const std::vector<Message>& messages) {
  std::vector<Message> received;
  received.reserve(messages.size());
  for (const Message& message : messages) received.push_back(throughBytes(message));
  return received;
}

}  // namespace sgraphs::test
