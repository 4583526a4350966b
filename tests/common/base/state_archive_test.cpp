#include "common/base/state_archive.h"

#include <gtest/gtest.h>

#include "common/geometry/se3.h"

namespace sgraphs {
namespace {

struct Inner {
  double number = 0;
  std::vector<Eigen::Vector3f> points;

  void visitState(auto& archive) { archive(number, points); }
};

// One of each kind that is known.
struct Everything {
  bool flag = false;
  int64_t count = 0;
  std::string text;
  SE3 pose;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<double> numbers;
  std::vector<Inner> inners;
  std::deque<Inner> queue;
  std::map<std::string, std::map<std::string, int64_t>> counts;
  std::optional<SE3> maybe, never;
  std::optional<std::pair<int, Inner>> both;

  void visitState(auto& archive) {
    archive(flag, count, text, pose, covariance, numbers, inners, queue, counts, maybe, never, both);
  }
};

Everything example() {
  Everything e;
  e.flag = true;
  e.count = -7;
  e.text = "walls";
  e.text[1] = 0;
  e.pose = {Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {1, 2, 3}};
  e.covariance(2, 5) = 4;
  e.numbers = {1, 2.5};
  e.inners = {{1, {}}, {2, {{1, 2, 3}, {4, 5, 6}}}};
  e.queue = {{3, {{7, 8, 9}}}};
  e.counts["a"]["b"] = 5;
  e.maybe = e.pose;
  e.both = {4, {5, {}}};
  return e;
}

std::vector<uint8_t> bytesOf(Everything e) {
  StateArchive archive;
  archive(e);
  return archive.takeBytes();
}

TEST(StateArchiveTest, WhatIsWrittenIsRead) {
  const std::vector<uint8_t> bytes = bytesOf(example());
  StateArchive archive(bytes);
  Everything read;
  // What is there before goes.
  read.never = SE3();
  read.queue.resize(5);
  read.counts["old"]["x"] = 1;
  archive(read);
  EXPECT_TRUE(archive.atEnd());
  EXPECT_EQ(read.inners.at(1).points.at(1), Eigen::Vector3f(4, 5, 6));
  EXPECT_EQ(read.queue.size(), 1u);
  EXPECT_EQ(read.pose.rotation.coeffs(), example().pose.rotation.coeffs());
  EXPECT_FALSE(read.never);
  EXPECT_EQ(read.both->second.number, 5);
  EXPECT_EQ(bytesOf(read), bytes);
}

TEST(StateArchiveTest, BytesThatEndTooSoonAreRefusedWhereverTheyEnd) {
  const std::vector<uint8_t> bytes = bytesOf(example());
  for (size_t n = 0; n < bytes.size(); ++n) {
    StateArchive archive(std::span<const uint8_t>(bytes).first(n));
    Everything read;
    EXPECT_THROW(archive(read), Error) << n;
  }
}

TEST(StateArchiveTest, ACountBeyondTheBytesIsRefusedBeforeRoomIsMade) {
  StateArchive writer;
  uint64_t n = uint64_t{1} << 60;
  writer(n);
  const std::vector<uint8_t> bytes = writer.takeBytes();
  std::vector<double> numbers;
  std::map<int, int> map;
  EXPECT_THROW(StateArchive{bytes}(numbers), Error);
  EXPECT_THROW(StateArchive{bytes}(map), Error);
}

}  // namespace
}  // namespace sgraphs
