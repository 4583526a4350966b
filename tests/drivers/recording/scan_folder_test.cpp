#include "drivers/recording/scan_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "common/base/error.h"
#include "drivers/recording/convert_recording.h"
#include "tests/common/test_files.h"
#include "tests/drivers/recording/log_contents.h"

namespace sgraphs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::vector<Eigen::Vector3f> kPoints{{1, 2, 3}, {-4.5f, 0.25f, 8}};

void writeKitti(const fs::path& path, const std::vector<Eigen::Vector3f>& points) {
  std::vector<uint8_t> bytes(16 * points.size());
  for (size_t i = 0; i < points.size(); ++i) std::memcpy(&bytes[16 * i], points[i].data(), 12);
  test::writeBytes(path, bytes);
}

void writePcd(const fs::path& path) {
  test::writeText(
      path,
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
      "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n1 2 3 9\n-4.5 0.25 8 9\n");
}

void writePly(const fs::path& path) {
  test::writeText(
      path,
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n1 2 3\n-4.5 0.25 8\n");
}

TEST(ScanFolderTest, ReadsAllThreeFormatsInOrderOfNames) {
  const fs::path folder = test::freshFolder();
  writePly(folder / "b.ply");
  writeKitti(folder / "c.bin", kPoints);
  writePcd(folder / "a.PCD");
  test::writeText(folder / "times.txt", "100.000001\n1.001e2\n100.25\n");
  test::writeText(folder / "readme.md", "not a scan");
  ScanFolder scans(folder);
  for (const int64_t time_us : {100'000'001, 100'100'000, 100'250'000}) {
    const auto scan = scans.next();
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->end.us, time_us);
    EXPECT_TRUE(scan->deskewed);
    EXPECT_EQ(scan->num_rings, 0);
    ASSERT_EQ(scan->points.size(), 2u);
    for (size_t i = 0; i < 2; ++i) EXPECT_EQ(scan->points[i].position_lidar, kPoints[i]);
  }
  EXPECT_FALSE(scans.next());
}

TEST(ScanFolderTest, PointsThatAreNotFiniteAreLeftOut) {
  const fs::path folder = test::freshFolder();
  writeKitti(folder / "a.bin", {kPoints[0], {std::numeric_limits<float>::quiet_NaN(), 0, 0}});
  test::writeText(folder / "times.txt", "1\n");
  EXPECT_EQ(ScanFolder(folder).next()->points.size(), 1u);
}

TEST(ScanFolderTest, TimesMustMatchTheScans) {
  const fs::path folder = test::freshFolder();
  const auto error = [&] { return test::messageOf<Error>([&] { ScanFolder scans(folder); }); };
  EXPECT_THAT(error(), HasSubstr("holds no scan"));
  writeKitti(folder / "a.bin", kPoints);
  writeKitti(folder / "b.bin", kPoints);
  EXPECT_THAT(error(), HasSubstr("times.txt"));
  test::writeText(folder / "times.txt", "1\n");
  EXPECT_THAT(error(), HasSubstr("1 times for 2 scans"));
  test::writeText(folder / "times.txt", "1\n1\n");
  EXPECT_THAT(error(), HasSubstr("time 2 ('1'): not later"));
  test::writeText(folder / "times.txt", "1\nsoon\n");
  EXPECT_THAT(error(), HasSubstr("not a number of seconds"));
  EXPECT_THAT(test::messageOf<Error>([] { ScanFolder scans("/no/such/folder"); }),
              HasSubstr("/no/such/folder"));
}

TEST(ScanFolderTest, ABrokenScanIsNamed) {
  const fs::path folder = test::freshFolder();
  test::writeText(folder / "a.bin", "seventeen bytes..");
  test::writeText(folder / "b.pcd", "no point cloud at all");
  test::writeText(folder / "c.ply", "no point cloud at all");
  for (const char* name : {"a.bin", "b.pcd", "c.ply"})
    EXPECT_THAT(test::messageOf<Error>([&] { readPoints(folder / name); }), HasSubstr(name));
}

TEST(ScanFolderTest, BecomesALogOfSweeps) {
  const fs::path folder = test::freshFolder();
  writeKitti(folder / "a.bin", kPoints);
  writeKitti(folder / "b.bin", kPoints);
  test::writeText(folder / "times.txt", "1.0\n1.1\n");
  ConvertOptions options;
  options.scans = folder;
  options.output = folder / "out.lcmlog";
  const ConvertReport report = convertRecording(options, [](double) {});
  EXPECT_EQ(report.scans, 2);
  const auto log = test::readLog(options.output);
  ASSERT_EQ(log.points.size(), 2u);
  EXPECT_EQ(log.points[1].sweep, 1);
  EXPECT_EQ(log.points[1].header.utime, 1'100'000);
  EXPECT_EQ(log.points[1].has_time, 0);
  EXPECT_EQ(log.order.back(), "STREAM_END");
}

TEST(ScanFolderTest, ReadsARealPly) {
  const std::string path = std::string(SGRAPHS_SHARED_DATA_DIR) + "/scans/small_gicp_kitti_like/source.ply";
  if (!fs::exists(path)) GTEST_SKIP() << "shared data absent: scans/small_gicp_kitti_like";
  const auto points = readPoints(path);
  EXPECT_EQ(points.size(), 69'792u);
  for (const Eigen::Vector3f& p : points) ASSERT_LT(p.norm(), 200.0f);
}

}  // namespace
}  // namespace sgraphs
