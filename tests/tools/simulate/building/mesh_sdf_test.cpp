#include "tools/simulate/building/mesh_sdf.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/tools/simulate/building/mesh_files.h"
#include "tools/simulate/building/mesh_surface.h"

namespace sgraphs::simulate {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

std::string sdf(const std::string& model) {
  return "<?xml version='1.0'?>\n<sdf version='1.6'><model name='m'>\n" + model + "</model></sdf>\n";
}

std::string link(const std::string& pose, const std::string& shapes) {
  return "<link name='l'><pose>" + pose + "</pose>" + shapes + "</link>\n";
}

std::string shape(const std::string& kind, const std::string& pose, const std::string& geometry) {
  return "<" + kind + " name='s'><pose frame=''>" + pose + "</pose><geometry>" + geometry + "</geometry></" +
         kind + ">";
}

std::string box(const std::string& size) {
  return "<box><size>" + size + "</size></box>";
}

std::string sdfComplaint(const std::string& text) {
  try {
    readSdf(writeMeshFile("wrong.sdf", text));
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  return "";
}

TEST(MeshSdfTest, BoxesStandAtThePosesOfModelLinkAndShape) {
  const auto one = writeMeshFile(
      "one.sdf", sdf("<pose>10 0 0 0 0 0</pose>" +
                     link("1 2 0 0 0 1.5707963", shape("visual", "0 0 1.25 0 0 0", box("4 0.2 2.5")))));
  const SdfSurfaces read = readSdf(one);
  EXPECT_EQ(read.mesh.triangles.size(), 12u);
  EXPECT_THAT(read.warnings, IsEmpty());
  expectBounds(read.mesh, {10.9, 0, 0}, {11.1, 4, 2.5}, 1e-4);
  // Two boxes in models within models.
  const auto two = writeMeshFile(
      "two.sdf", sdf(link("0 0 0 0 0 0", shape("visual", "0 0 0.5 0 0 0", box("1 1 1"))) +
                     "<model name='inner'><pose>5 0 0 0 0 0</pose>" +
                     link("0 1 0 0 0 0", shape("visual", "0 0 0.5 0 0 0", box("1 1 1"))) + "</model>"));
  EXPECT_EQ(readSdf(two).mesh.triangles.size(), 24u);
  expectBounds(readSdf(two).mesh, {-0.5, -0.5, 0}, {5.5, 1.5, 1}, 1e-4);
}

TEST(MeshSdfTest, RollPitchAndYawTurnAboutFixedAxes) {
  // Roll by 90 degrees lays the height along -y, yaw by 90 degrees turns that to +x.
  const auto path = writeMeshFile("turned.sdf", sdf(link("0 0 0 1.5707963 0 1.5707963",
                                                         shape("visual", "0 0 1 0 0 0", box("0.2 0.2 2")))));
  expectBounds(readSdf(path).mesh, {0, -0.1, -0.1}, {2, 0.1, 0.1}, 1e-4);
}

TEST(MeshSdfTest, WhatIsSeenComesBeforeWhatIsTouched) {
  const std::string small = shape("visual", "0 0 0 0 0 0", box("1 1 1"));
  const std::string large = shape("collision", "0 0 0 0 0 0", box("3 3 3"));
  const auto both = writeMeshFile("both.sdf", sdf(link("0 0 0 0 0 0", large + small)));
  expectBounds(readSdf(both).mesh, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, 1e-4);
  const auto touched = writeMeshFile("touched.sdf", sdf(link("0 0 0 0 0 0", large)));
  expectBounds(readSdf(touched).mesh, {-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}, 1e-4);
}

TEST(MeshSdfTest, CylindersAndMeshesBesideTheFile) {
  TriangleMesh cube;
  cube.addBox({0, 0, 0.5}, {1, 1, 1}, 0, 50);
  writeMeshFile("cube.obj", asObj(cube));
  const auto path = writeMeshFile(
      "shapes.sdf",
      sdf(link("0 0 0 0 0 0",
               shape("visual", "0 0 1 0 0 0", "<cylinder><radius>0.5</radius><length>2</length></cylinder>") +
                   shape("visual", "3 0 0 0 0 0",
                         "<mesh><uri>model://house/cube.obj</uri><scale>2 1 3</scale></mesh>"))));
  const SdfSurfaces read = readSdf(path);
  EXPECT_THAT(read.warnings, IsEmpty());
  expectBounds(read.mesh, {-0.5, -0.5, 0}, {4, 0.5, 3}, 1e-4);
  EXPECT_EQ(findOpenEdges(read.mesh).count, 0);
}

TEST(MeshSdfTest, MissingMeshesAreReplacedByTheirCollisionsAndNamedOnce) {
  const std::string table =
      shape("visual", "0 0 0 0 0 0", "<mesh><uri>model://house/table.dae</uri></mesh>") +
      shape("collision", "0 0 0.4 0 0 0", box("1 1 0.8"));
  const auto path = writeMeshFile("tables.sdf", sdf(link("0 0 0 0 0 0", table) + link("5 0 0 0 0 0", table)));
  const SdfSurfaces read = readSdf(path);
  expectBounds(read.mesh, {-0.5, -0.5, 0}, {5.5, 0.5, 0.8}, 1e-4);
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_THAT(read.warnings[0], AllOf(HasSubstr("1 mesh"), HasSubstr("model://house/table.dae")));
}

TEST(MeshSdfTest, UnknownShapesAndIncludesAreWarnedOf) {
  const auto path = writeMeshFile(
      "unknown.sdf", "<sdf><world name='w'><include><uri>model://sun</uri></include><model name='m'>" +
                         link("0 0 0 0 0 0", shape("visual", "0 0 0 0 0 0", "<capsule/>") +
                                                 shape("visual", "0 0 0 0 0 0", box("1 1 1"))) +
                         "</model></world></sdf>");
  const SdfSurfaces read = readSdf(path);
  EXPECT_EQ(read.mesh.triangles.size(), 12u);
  ASSERT_EQ(read.warnings.size(), 2u);
  EXPECT_THAT(read.warnings[0], HasSubstr("<capsule>"));
  EXPECT_THAT(read.warnings[1], HasSubstr("<include>"));
}

TEST(MeshSdfTest, WrongElementsAreNamedWithTheirLine) {
  EXPECT_THAT(sdfComplaint("<sdf><model>"), AllOf(HasSubstr("wrong.sdf:"), HasSubstr("not XML")));
  EXPECT_THAT(sdfComplaint("<robot/>"), HasSubstr("no <sdf>"));
  EXPECT_THAT(sdfComplaint(sdf(link("0 0 0 0 0", ""))), AllOf(HasSubstr(":3:"), HasSubstr("6 numbers")));
  EXPECT_THAT(sdfComplaint(sdf(link("0 0 0 0 0 0", shape("visual", "0 0 0 0 0 0", box("1 x 1"))))),
              HasSubstr("<size> must hold 3 numbers"));
  EXPECT_THAT(sdfComplaint(sdf(link("0 0 0 0 0 0", shape("visual", "0 0 0 0 0 0", "<box/>")))),
              HasSubstr("lacks <size>"));
  EXPECT_THAT(sdfComplaint(sdf("<link name='l'><pose relative_to='door'>0 0 0 0 0 0</pose></link>")),
              AllOf(HasSubstr("link 'l'"), HasSubstr("'door'")));
}

TEST(MeshSdfTest, AHouseOfOthersHasTheSizeOfAHouse) {
  const std::string path = SGRAPHS_SHARED_DATA_DIR "/env/turtlebot3_house/model.sdf";
  if (!std::ifstream(path)) GTEST_SKIP() << path << " is absent";
  const SdfSurfaces read = readSdf(path);
  const Eigen::Vector3d size = boundsOf(read.mesh).sizes();
  EXPECT_GT(size.head<2>().minCoeff(), 8);
  EXPECT_LT(size.head<2>().maxCoeff(), 25);
  EXPECT_NEAR(size.z(), 2.5, 0.3);
  EXPECT_EQ(read.warnings.size(), 1u);  // its furniture's meshes are not there
}

}  // namespace
}  // namespace sgraphs::simulate
