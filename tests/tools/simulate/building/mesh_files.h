#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tools/simulate/building/mesh_surface.h"

namespace sgraphs::simulate {

inline std::string writeMeshFile(const std::string& name, const std::string& text) {
  // Tests run side by side: each has its own folder.
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const std::string folder = testing::TempDir() + "/" + test->test_suite_name() + "_" + test->name();
  std::filesystem::create_directories(folder);
  std::string path = folder + "/" + name;
  std::ofstream(path) << text;
  return path;
}

inline void expectBounds(const TriangleMesh& mesh, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                         double within_m) {
  const Eigen::AlignedBox3d bounds = boundsOf(mesh);
  EXPECT_LT((bounds.min() - low).norm(), within_m) << bounds.min().transpose();
  EXPECT_LT((bounds.max() - high).norm(), within_m) << bounds.max().transpose();
}

// Upright boxes as an OBJ or an ASCII STL.
inline std::string asObj(const TriangleMesh& mesh) {
  std::string text = "# written by a test\n";
  for (const auto& v : mesh.vertices)
    text += "v " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
  for (const auto& t : mesh.triangles) {
    text += "f";
    for (const uint32_t i : t) text += " " + std::to_string(i + 1);
    text += "\n";
  }
  return text;
}

inline std::string asStl(const TriangleMesh& mesh) {
  std::string text = "solid test\n";
  for (const auto& t : mesh.triangles) {
    text += "facet normal 0 0 1\nouter loop\n";
    for (const uint32_t i : t) {
      const auto& v = mesh.vertices[i];
      text += "vertex " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) +
              "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid test\n";
}

}  // namespace sgraphs::simulate
