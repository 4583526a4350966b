#include "common/io/tum.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.h"
#include "tests/common/test_files.h"

namespace sgraphs {
namespace {

using testing::HasSubstr;

std::vector<StampedPose> read(const std::string& text) {
  const auto path = test::freshFolder() / "poses.tum";
  test::writeText(path, text);
  return readTum(path);
}

std::string errorOf(const std::string& text) {
  return test::messageOf<Error>([&] { read(text); });
}

TEST(TumTest, ReadsRowsCommentsAndQuaternionOrder) {
  const auto poses = read("# t x y z qx qy qz qw\n10.5 1 2 3 0 0 0.6 0.8\n\n11 4 5 6 0 0 0 1\n");
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].time.us, 10'500'000);
  EXPECT_EQ(poses[0].pose.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_DOUBLE_EQ(poses[0].pose.rotation.z(), 0.6);
  EXPECT_DOUBLE_EQ(poses[0].pose.rotation.w(), 0.8);
  EXPECT_EQ(poses[1].time.us, 11'000'000);
}

TEST(TumTest, NoMicrosecondIsLost) {
  Time time;
  ASSERT_TRUE(parseSeconds("1700000000.123457", time));
  EXPECT_EQ(time.us, 1'700'000'000'123'457);
  ASSERT_TRUE(parseSeconds("1700000000.1234565", time));
  EXPECT_EQ(time.us, 1'700'000'000'123'457);
  ASSERT_TRUE(parseSeconds("1700000000.9999999", time));
  EXPECT_EQ(time.us, 1'700'000'001'000'000);
  ASSERT_TRUE(parseSeconds("1.5e2", time));
  EXPECT_EQ(time.us, 150'000'000);
  ASSERT_TRUE(parseSeconds("-0.25", time));
  EXPECT_EQ(time.us, -250'000);
}

TEST(TumTest, WhatIsNoTimeIsRefused) {
  Time time;
  for (const char* text : {"", ".", "abc", "1.2.3", "1.5x", "nan", "inf", "1e300"})
    EXPECT_FALSE(parseSeconds(text, time)) << "'" << text << "'";
}

TEST(TumTest, WriteAndReadAgree) {
  const auto path = test::freshFolder() / "out.tum";
  std::vector<StampedPose> poses;
  for (int i = 0; i < 10; ++i) {
    Vector6d xi;
    xi << i, -0.3 * i, 0.01, 0.1 * i, 0.05, -0.2 * i;
    poses.push_back({Time{1'700'000'000'000'001 + 100'003 * i}, se3Exp(xi)});
  }
  writeTum(path, poses);
  const auto read = readTum(path);
  ASSERT_EQ(read.size(), poses.size());
  for (size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(read[i].time, poses[i].time);
    EXPECT_LT(se3Log(read[i].pose.inverse() * poses[i].pose).norm(), 1e-8);
  }
}

TEST(TumTest, BadRowsAreNamedByFileAndLine) {
  const std::string good = "1 0 0 0 0 0 0 1\n";
  EXPECT_THAT(errorOf(good + "2 0 0 0 0 0 0\n"), HasSubstr("poses.tum:2: not a TUM row"));
  EXPECT_THAT(errorOf(good + "2 0 0 nan 0 0 0 1\n"), HasSubstr("poses.tum:2"));
  EXPECT_THAT(errorOf(good + "2 0 0 0 0 0 0 0.5\n"), HasSubstr("unit quaternion"));
  EXPECT_THAT(errorOf(good + "0.5 0 0 0 0 0 0 1\n"), HasSubstr("time runs backwards"));
  EXPECT_THAT(errorOf("# nothing\n"), HasSubstr("holds no pose"));
  EXPECT_THAT(test::messageOf<Error>([] { readTum("/no/such.tum"); }), HasSubstr("/no/such.tum"));
}

TEST(TumTest, AFolderThatIsMissingIsNamed) {
  EXPECT_THAT(test::messageOf<Error>([] { writeTum("/no/such/file.tum", {}); }), HasSubstr("/no/such"));
}

}  // namespace
}  // namespace sgraphs
