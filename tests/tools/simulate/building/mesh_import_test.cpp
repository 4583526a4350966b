#include "tools/simulate/building/mesh_import.h"

#include <gmock/gmock.h>

#include <numbers>

#include "common/base/error.h"
#include "tests/tools/simulate/building/mesh_files.h"
#include "tools/simulate/building/mesh_surface.h"

namespace sgraphs::simulate {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// 4 x 3 x 2 m, its lowest corner at the origin.
TriangleMesh room() {
  TriangleMesh mesh;
  mesh.addBox({2, 1.5, 1}, {4, 3, 2}, 0, 50);
  return mesh;
}

// A box of the same size as a Collada file: in its own unit, along its own upward axis, under two nodes.
std::string collada(const std::string& unit, const std::string& up, const std::string& positions,
                    const std::string& nodes) {
  return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter=")" +
         unit + R"("/><up_axis>)" + up + R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">)" +
         positions + R"(</float_array><technique_common><accessor source="#a" count="4" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">)" +
         nodes + R"(</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

std::string importComplaint(const MeshFile& file) {
  try {
    importMesh(file);
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  return "";
}

TEST(MeshImportTest, PlyObjAndStlComeAsTheyAreWritten) {
  const std::string ply = testing::TempDir() + "/room.ply";
  writePly(ply, room());
  for (const std::string& path :
       {ply, writeMeshFile("room.obj", asObj(room())), writeMeshFile("room.STL", asStl(room()))}) {
    const ImportedMesh imported = importMesh({path, 1, {}});
    EXPECT_EQ(imported.mesh.triangles.size(), 12u) << path;
    EXPECT_EQ(imported.mesh.reflectivity.size(), 12u) << path;
    EXPECT_THAT(imported.warnings, testing::IsEmpty()) << path;
    expectBounds(imported.mesh, {0, 0, 0}, {4, 3, 2}, 1e-5);
  }
}

TEST(MeshImportTest, PolygonsBecomeTriangles) {
  const auto path = writeMeshFile("quad.obj", "v 0 0 0\nv 3 0 0\nv 3 2 0\nv 0 2 0\nf 1 2 3 4\n");
  EXPECT_EQ(importMesh({path, 1, {}}).mesh.triangles.size(), 2u);
}

TEST(MeshImportTest, ColladaUnitsUpwardAxesAndNodesAreRespected) {
  const std::string nodes = R"(<node><translate>0 0 100</translate><node><translate>50 0 0</translate>
      <instance_geometry url="#g"/></node></node>)";
  // Corners of a tetrahedron 4 m along x, 3 m along y, 2 m up, in centimetres; nodes shift x by 0.5, z by 1.
  const auto z_up =
      writeMeshFile("z_up.dae", collada("0.01", "Z_UP", "0 0 0 400 0 0 0 300 0 0 0 200", nodes));
  expectBounds(importMesh({z_up, 1, {}}).mesh, {0.5, 0, 1}, {4.5, 3, 3}, 1e-5);
  // The same where y points up and z to the south.
  const std::string y_nodes = R"(<node><translate>0 100 0</translate><node><translate>50 0 0</translate>
      <instance_geometry url="#g"/></node></node>)";
  const auto y_up =
      writeMeshFile("y_up.dae", collada("0.01", "Y_UP", "0 0 0 400 0 0 0 0 -300 0 200 0", y_nodes));
  expectBounds(importMesh({y_up, 1, {}}).mesh, {0.5, 0, 1}, {4.5, 3, 3}, 1e-5);
}

TEST(MeshImportTest, ScaleComesBeforeThePose) {
  const auto path = writeMeshFile("scaled.obj", asObj(room()));
  const SE3 T(Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ())),
              {10, 0, 1});
  expectBounds(importMesh({path, 2, T}).mesh, {10 - 6, 0, 1}, {10, 8, 5}, 1e-5);
}

TEST(MeshImportTest, HolesAreWarnedOfInOneLineThatSaysWhere) {
  TriangleMesh open = room();
  open.triangles.pop_back();  // half of the lid
  open.reflectivity.pop_back();
  const auto imported = importMesh({writeMeshFile("open.obj", asObj(open)), 1, {}});
  ASSERT_EQ(imported.warnings.size(), 1u);
  EXPECT_THAT(imported.warnings[0],
              AllOf(HasSubstr("open.obj"), HasSubstr("3 edges"), HasSubstr("rays pass")));
  EXPECT_THAT(imported.warnings[0], HasSubstr("2.00)"));  // at the height of the lid
}

TEST(MeshImportTest, TrianglesWithoutAreaAreLeftOutAndCounted) {
  const auto path = writeMeshFile("flat.obj", asObj(room()) + "f 1 1 2\nf 1 2 2\n");
  const auto imported = importMesh({path, 1, {}});
  EXPECT_EQ(imported.mesh.triangles.size(), 12u);
  ASSERT_EQ(imported.warnings.size(), 1u);
  EXPECT_THAT(imported.warnings[0], HasSubstr("2 triangles without area"));
}

TEST(MeshImportTest, WhatIsNoBuildingIsRefusedInOneLine) {
  EXPECT_THAT(importComplaint({"/nowhere/house.ply", 1, {}}), HasSubstr("'/nowhere/house.ply' is not there"));
  EXPECT_THAT(importComplaint({"house.blend", 1, {}}), AllOf(HasSubstr("unknown kind"), HasSubstr(".sdf")));
  EXPECT_THAT(importComplaint({writeMeshFile("broken.dae", "<COLLADA"), 1, {}}), HasSubstr("cannot be read"));
  EXPECT_THAT(importComplaint({writeMeshFile("broken.ply", "ply\nnonsense"), 1, {}}),
              HasSubstr("broken.ply"));
  EXPECT_THAT(importComplaint({writeMeshFile("empty.stl", ""), 1, {}}), HasSubstr("empty.stl"));
  EXPECT_THAT(
      importComplaint({writeMeshFile("points.ply",
                                     "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty "
                                     "float y\nproperty float z\nend_header\n0 0 0\n1 1 1\n"),
                       1,
                       {}}),
      HasSubstr("points.ply"));
  EXPECT_THAT(importComplaint({writeMeshFile("nan.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n"), 1, {}}),
              HasSubstr("not finite"));
  EXPECT_THAT(
      importComplaint(
          {writeMeshFile("line.obj", asObj(room()).substr(0, 20) + "\nv 0 0 0\nv 1 0 0\nl 1 2\n"), 1, {}}),
      HasSubstr("line.obj"));
}

TEST(MeshImportTest, SizesInAnotherUnitNameTheScale) {
  const auto path = writeMeshFile("millimetres.obj", asObj(room()));
  EXPECT_THAT(importComplaint({path, 1000, {}}), AllOf(HasSubstr("4e+03 m long"), HasSubstr("scale=0.001")));
  EXPECT_THAT(importComplaint({path, 0.001, {}}), AllOf(HasSubstr("0.004 m long"), HasSubstr("scale=1000")));
  EXPECT_THAT(importComplaint({path, 1, {Eigen::Quaterniond::Identity(), {4e6, 0, 0}}}),
              HasSubstr("T_building_mesh"));
}

TEST(MeshImportTest, AnOfficeOfOthersHasTheSizeOfAnOffice) {
  const std::string path = SGRAPHS_SHARED_DATA_DIR "/env/cpr_office/office.dae";
  if (!std::ifstream(path)) GTEST_SKIP() << path << " is absent";
  const auto imported = importMesh({path, 1, {}});
  const Eigen::Vector3d size = boundsOf(imported.mesh).sizes();
  EXPECT_GT(size.head<2>().minCoeff(), 5);
  EXPECT_LT(size.head<2>().maxCoeff(), 100);
  EXPECT_GT(size.z(), 2);
  EXPECT_LT(size.z(), 6);
}

}  // namespace
}  // namespace sgraphs::simulate
