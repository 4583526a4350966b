#include "common/base/sha256.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.h"
#include "tests/common/test_files.h"

namespace sgraphs {
namespace {

// FIPS 180-2, appendix B.
constexpr char kOfAbc[] = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
constexpr char kOfNothing[] = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";

TEST(Sha256Test, GivesThePublishedDigests) {
  EXPECT_EQ(Sha256().hex(), kOfNothing);
  Sha256 sha;
  sha.addBytes(std::vector<uint8_t>{'a', 'b', 'c'});
  EXPECT_EQ(sha.hex(), kOfAbc);
}

TEST(Sha256Test, DigestsAFileAsItsBytes) {
  const auto path = test::freshFolder() / "abc";
  test::writeText(path, "abc");
  EXPECT_EQ(sha256OfFile(path), kOfAbc);
  const std::string missing = test::messageOf<Error>([&] { sha256OfFile(path.string() + "x"); });
  EXPECT_THAT(missing, testing::HasSubstr("abcx"));
}

TEST(Sha256Test, StringsCarryTheirLength) {
  Sha256 one, other;
  one.add(std::string_view("ab"));
  one.add(std::string_view("c"));
  other.add(std::string_view("a"));
  other.add(std::string_view("bc"));
  EXPECT_NE(one.hex(), other.hex());
}

TEST(Sha256Test, IntegersAndDoublesAreTheirLittleEndianBytes) {
  Sha256 values, bytes;
  values.add(int64_t{0x0102030405060708});
  values.add(1.0);
  bytes.addBytes(std::vector<uint8_t>{8, 7, 6, 5, 4, 3, 2, 1, 0, 0, 0, 0, 0, 0, 0xF0, 0x3F});
  EXPECT_EQ(values.hex(), bytes.hex());
}

TEST(Sha256Test, MatricesGoRowByRow) {
  Eigen::Matrix2d m;
  m << 1, 2, 3, 4;
  Sha256 matrix, values;
  matrix.add(m);
  for (const double v : {1.0, 2.0, 3.0, 4.0}) values.add(v);
  EXPECT_EQ(matrix.hex(), values.hex());
}

}  // namespace
}  // namespace sgraphs
