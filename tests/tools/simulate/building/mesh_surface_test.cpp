#include "tools/simulate/building/mesh_surface.h"

#include <gtest/gtest.h>

#include <numbers>

namespace sgraphs::simulate {
namespace {

TriangleMesh cube() {
  TriangleMesh mesh;
  mesh.addBox({0, 0, 0}, {1, 1, 1}, 0, 40);
  return mesh;
}

TEST(MeshSurfaceTest, ClosedBoxesAndCylindersHaveNoOpenEdge) {
  EXPECT_EQ(findOpenEdges(cube()).count, 0);
  EXPECT_EQ(findOpenEdges(makeCylinder(0.3, 2)).count, 0);
}

TEST(MeshSurfaceTest, VerticesWithinAHundredthOfAMillimetreAreOne) {
  // Each face's own corners, moved a little; cells of the search begin at 0.
  for (const double shift : {0.0, 0.5, 1.2345678}) {
    TriangleMesh shaken = cube();
    for (size_t i = 0; i < shaken.vertices.size(); ++i)
      shaken.vertices[i] += Eigen::Vector3d::Constant(shift + (i % 2 ? 2e-6 : -2e-6));
    EXPECT_EQ(findOpenEdges(shaken).count, 0) << shift;
  }
  TriangleMesh torn = cube();
  for (size_t i = 0; i < 4; ++i) torn.vertices[i].x() -= 1e-3;  // one face stands off
  EXPECT_EQ(findOpenEdges(torn).count, 8);
}

TEST(MeshSurfaceTest, FirstOpenEdgeIsThatOfTheFirstTriangle) {
  TriangleMesh open = cube();
  append(open, {{{10, 0, 0}, {12, 0, 0}, {10, 2, 0}}, {{0, 1, 2}}, {40}});
  const OpenEdges edges = findOpenEdges(open);
  EXPECT_EQ(edges.count, 3);
  EXPECT_LT((edges.first - Eigen::Vector3d(11, 0, 0)).norm(), 1e-9);
}

TEST(MeshSurfaceTest, AppendScalesThenMoves) {
  TriangleMesh mesh = cube();
  const SE3 T(Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ())),
              {5, 0, 0});
  append(mesh, cube(), T, {4, 1, 1});
  EXPECT_EQ(mesh.triangles.size(), 24u);
  EXPECT_EQ(mesh.reflectivity.size(), 24u);
  const Eigen::AlignedBox3d bounds = boundsOf(mesh);
  EXPECT_LT((bounds.max() - Eigen::Vector3d(5.5, 2, 0.5)).norm(), 1e-9);
}

TEST(MeshSurfaceTest, OnlyTrianglesWithoutAreaAreDropped) {
  TriangleMesh mesh = cube();
  addTriangle(mesh, {0, 0, 1}, 40);
  mesh.vertices.insert(mesh.vertices.end(), {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1e-3, 0}});
  const auto n = static_cast<uint32_t>(mesh.vertices.size());
  addTriangle(mesh, {n - 4, n - 3, n - 2}, 40);  // on a line
  addTriangle(mesh, {n - 4, n - 3, n - 1}, 40);  // thin, but seen
  EXPECT_EQ(dropDegenerate(mesh), 2);
  EXPECT_EQ(mesh.triangles.size(), 13u);
  EXPECT_EQ(mesh.reflectivity.size(), 13u);
}

}  // namespace
}  // namespace sgraphs::simulate
