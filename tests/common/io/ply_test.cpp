#include "common/io/ply.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "common/base/error.h"
#include "common/io/text_file.h"
#include "tests/support/temp_folder.h"

namespace sgraphs {
namespace {

std::string errorOf(const std::string& bytes) {
  const test::TempFolder folder;
  writeFile(folder / "bad.ply", bytes);
  try {
    readPlyMesh(folder / "bad.ply");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

const std::string kHead =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST(PlyTest, PointsSurviveARoundTrip) {
  const test::TempFolder folder;
  const PointCloud cloud{{{1.5f, -2, 3e-3f}, {1e6f, 0, -1}}, {0, 7}};
  writePlyPoints(folder / "points.ply", cloud);
  const PointCloud read = readPlyPoints(folder / "points.ply");
  EXPECT_EQ(read.points, cloud.points);
  EXPECT_EQ(read.floors, cloud.floors);
  // Header and 13 bytes per point: x y z as float32, floor as uint8.
  const std::string bytes = readFile(folder / "points.ply");
  EXPECT_EQ(bytes.size() - bytes.find("end_header\n") - 11, 26u);
}

TEST(PlyTest, MeshSurvivesARoundTrip) {
  const test::TempFolder folder;
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.25}}, {{0, 1, 2}}};
  writePlyMesh(folder / "mesh.ply", mesh);
  const TriangleMesh read = readPlyMesh(folder / "mesh.ply");
  EXPECT_EQ(read.vertices, mesh.vertices);
  EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST(PlyTest, PolygonsBecomeFansAndOtherPropertiesAreSkipped) {
  const test::TempFolder folder;
  writeFile(
      folder / "quad.ply",
      "ply\r\nformat ascii 1.0\r\ncomment by hand\r\nelement vertex 4\r\nproperty uchar red\r\nproperty "
      "double x\r\n"
      "property double y\r\nproperty double z\r\nelement face 1\r\nproperty list uchar int vertex_index\r\n"
      "end_header\r\n9 0 0 0\r\n9 1 0 0\r\n9 1 1 0\r\n9 0 1 0\r\n4 0 1 2 3\r\n");
  const TriangleMesh mesh = readPlyMesh(folder / "quad.ply");
  EXPECT_EQ(mesh.vertices[2], Eigen::Vector3d(1, 1, 0));
  EXPECT_THAT(mesh.triangles, testing::ElementsAre(Eigen::Vector3i(0, 1, 2), Eigen::Vector3i(0, 2, 3)));
}

TEST(PlyTest, BadFilesAreToldApart) {
  EXPECT_THAT(errorOf("solid stl"), testing::HasSubstr("does not begin with 'ply'"));
  EXPECT_THAT(errorOf("ply\nformat binary_big_endian 1.0\nend_header\n"),
              testing::HasSubstr("not supported"));
  EXPECT_THAT(errorOf("ply\nformat ascii 1.0\n"), testing::HasSubstr("end_header"));
  EXPECT_THAT(errorOf(kHead + "0 0 0\n1 0 0\n"), testing::HasSubstr("cut short"));
  EXPECT_THAT(errorOf(kHead + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 9\n"), testing::HasSubstr("does not exist"));
  EXPECT_THAT(errorOf(kHead + "0 0 0\n1 0 nan\n1 1 0\n0 1 0\n3 0 1 2\n"), testing::HasSubstr("finite"));
  EXPECT_THAT(errorOf("ply\nformat ascii 1.0\nelement vertex 9999999999\nproperty float x\nend_header\n"),
              testing::HasSubstr("promises more"));
}

TEST(PlyTest, ReadsTheSharedBuilding) {
  const std::string path = std::string(SGRAPHS_SHARED_DATA_DIR) + "/office_ring/mesh.ply";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  const TriangleMesh mesh = readPlyMesh(path);
  EXPECT_EQ(mesh.vertices.size(), 680u);
  EXPECT_EQ(mesh.triangles.size(), 340u);
}

}  // namespace
}  // namespace sgraphs
