#include "tools/simulate/scene/find_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "common/base/error.h"
#include "tools/simulate/scene/scene_file.h"
#include "tools/simulate/walk/walk.h"

namespace sgraphs::simulate {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(FindSceneTest, ShippedScenesAreFoundByNameAndLoad) {
  for (const char* name : {"small_office", "two_rooms"}) {
    const Scene scene = loadScene(findScene(name));
    EXPECT_EQ(scene.name, name);
    EXPECT_GT(se3Log(scene.T_body_lidar).norm(), 0.1);
    const double seconds = walkAlong(scene.path, scene.start, 0).duration().seconds();
    EXPECT_LT(seconds, std::string(name) == "two_rooms" ? 25 : 80);
  }
}

TEST(FindSceneTest, EnvironmentOverridesTheShippedScenes) {
  const std::string folder = testing::TempDir() + "/scenes";
  std::filesystem::create_directories(folder + "/mine");
  std::ofstream(folder + "/mine/plan.json")
      << R"({"walls": [{"a": [0, 0], "b": [4, 0], "thickness": 0.1, "z": [0, 2]}],
                                               "path": {"waypoints": [[2, 1]]}})";
  ASSERT_EQ(setenv("SGRAPHS_SCENES", folder.c_str(), 1), 0);
  EXPECT_EQ(loadScene(findScene("mine")).name, "mine");
  EXPECT_THROW(findScene("small_office"), UsageError);
  unsetenv("SGRAPHS_SCENES");
  EXPECT_EQ(findScene(folder + "/mine"), folder + "/mine/plan.json");
}

TEST(FindSceneTest, UnknownScenesAndMeshesAreUsageErrors) {
  try {
    findScene("nowhere");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("nowhere"), HasSubstr("small_office"), HasSubstr("two_rooms")));
  }
  for (const char* mesh : {"house.ply", "office.DAE", "a/b/model.sdf"}) {
    try {
      findScene(mesh);
      FAIL();
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr(mesh), HasSubstr("is not there")));
    }
  }
}

TEST(FindSceneTest, MeshesAreFoundByTheirPath) {
  const std::string path = testing::TempDir() + "/found.STL";
  std::ofstream(path) << "solid";
  EXPECT_EQ(findScene(path), path);
  EXPECT_TRUE(isMeshPath(path));
  EXPECT_FALSE(isMeshPath("plan.json"));
}

}  // namespace
}  // namespace sgraphs::simulate
