#include "tools/simulate/scene/scene_source.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "common/base/error.h"
#include "tests/tools/simulate/building/mesh_files.h"
#include "tools/simulate/building/mesh_surface.h"

namespace sgraphs::simulate {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

// Walls of a room of 6 x 4 m from z = 1 to 3.5, with a floor or without.
std::string room(const std::string& name, bool with_floor) {
  TriangleMesh mesh;
  if (with_floor) mesh.addBox({3, 2, 0.9}, {6.2, 4.2, 0.2}, 0, 50);
  mesh.addBox({3, -0.05, 2.25}, {6.2, 0.1, 2.5}, 0, 50);
  mesh.addBox({3, 4.05, 2.25}, {6.2, 0.1, 2.5}, 0, 50);
  mesh.addBox({-0.05, 2, 2.25}, {0.1, 4, 2.5}, 0, 50);
  mesh.addBox({6.05, 2, 2.25}, {0.1, 4, 2.5}, 0, 50);
  return writeMeshFile(name, asObj(mesh));
}

std::string walk(const std::string& text = "[[1, 1], [4, 1]]") {
  return writeMeshFile("walk.json", text);
}

template <typename Kind = Error>
std::string sourceComplaint(const SceneRequest& request) {
  try {
    openScene(request);
  } catch (const Kind& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  return "";
}

TEST(SceneSourceTest, MeshWithAWalkIsASceneOnItsOwnFloor) {
  const SceneSource source = openScene({room("floor.obj", true), walk(), {}});
  EXPECT_EQ(source.scene.name, "floor");
  EXPECT_NEAR(source.scene.floors_z_m[0], 1.0, 1e-4);
  EXPECT_EQ(source.scene.path.waypoints.size(), 2u);
  EXPECT_EQ(source.imported.triangles.size(), 60u);
  EXPECT_TRUE(source.scene.slabs.empty());
  EXPECT_THAT(source.warnings, IsEmpty());
}

TEST(SceneSourceTest, GroundIsLaidWhereThereIsNone) {
  const SceneSource source = openScene({room("bare.obj", false), walk(), {}});
  EXPECT_NEAR(source.scene.floors_z_m[0], 1.0, 1e-4);
  ASSERT_EQ(source.scene.slabs.size(), 1u);
  EXPECT_NEAR(source.scene.slabs[0].z_max_m, 1.0, 1e-4);
  EXPECT_LT(source.scene.slabs[0].min.x(), -1);
  ASSERT_EQ(source.warnings.size(), 1u);
  EXPECT_THAT(source.warnings[0], HasSubstr("no floor under the first waypoint"));
  const SceneSource chosen = openScene({room("bare.obj", false), walk(), {"floors=[1.2]"}});
  EXPECT_EQ(chosen.scene.floors_z_m[0], 1.2);
  EXPECT_TRUE(chosen.scene.slabs.empty());
}

TEST(SceneSourceTest, MeshWithoutWaypointsSaysWhatToGive) {
  EXPECT_THAT(sourceComplaint<UsageError>({room("room.obj", true), "", {}}),
              AllOf(HasSubstr("--waypoints"), HasSubstr("[[x, y], …]")));
}

TEST(SceneSourceTest, WalkIsAPathObjectOrAList) {
  const auto source =
      openScene({room("room.obj", true), walk(R"({"waypoints": [[1, 1]], "start_heading_deg": 90})"), {}});
  EXPECT_NEAR(source.scene.path.start_heading_rad, 1.5707963, 1e-6);
  EXPECT_THAT(sourceComplaint({room("room.obj", true), walk("7"), {}}), HasSubstr("list of waypoints"));
  EXPECT_THAT(sourceComplaint({room("room.obj", true), walk("[[1, 1]"), {}}), HasSubstr("not JSON: line 1"));
  EXPECT_THAT(sourceComplaint({room("room.obj", true), "/nowhere.json", {}}), HasSubstr("'/nowhere.json'"));
}

TEST(SceneSourceTest, WalkThroughTheMeshIsRefused) {
  EXPECT_THAT(sourceComplaint({room("room.obj", true), walk("[[1, 1], [5.9, 1]]"), {}}),
              AllOf(HasSubstr("walk.json"), HasSubstr("path.waypoints[1]"), HasSubstr("0.10 m")));
  EXPECT_THAT(sourceComplaint({room("room.obj", true), walk("[[1, 1], [8, 1]]"), {}}), HasSubstr("mesh"));
}

TEST(SceneSourceTest, PlansTakeMeshesFromBesideThem) {
  room("beside.obj", true);
  const auto plan = writeMeshFile("plan_with_mesh.json", R"({"floors": [1],
      "meshes": [{"path": "beside.obj", "T_building_mesh": {"xyz": [10, 0, 0], "rpy_deg": [0, 0, 0]}}],
      "path": {"waypoints": [[12, 2]]}})");
  const SceneSource source = openScene({plan, "", {}});
  EXPECT_NEAR(boundsOf(source.imported).min().x(), 9.9, 1e-4);
  EXPECT_THAT(sourceComplaint({plan, "", {"meshes.0.path=gone.obj"}}), HasSubstr("gone.obj' is not there"));
}

TEST(SceneSourceTest, OverridesReachTheSceneAndTheDigest) {
  const SceneRequest plain{"two_rooms", "", {}};
  SceneRequest changed = plain;
  changed.overrides = {"sensor.range_sigma_m=0.03", "path.start_heading_deg=45"};
  const SceneSource a = openScene(plain), b = openScene(changed);
  EXPECT_EQ(b.scene.sensor.range_sigma_m, 0.03);
  EXPECT_NEAR(b.scene.path.start_heading_rad, 0.78539816, 1e-6);
  EXPECT_EQ(b.scene.name, a.scene.name);
  EXPECT_NE(a.digest, b.digest);
  EXPECT_EQ(a.digest, openScene(plain).digest);
  EXPECT_THAT(sourceComplaint({"two_rooms", "", {"sensor.range_sigma=0.03"}}), HasSubstr("range_sigma_m"));
  EXPECT_THAT(sourceComplaint<UsageError>({"two_rooms", "", {"nonsense=1"}}), HasSubstr("no 'nonsense'"));
}

TEST(SceneSourceTest, DigestKnowsTheMeshAndNotItsPlace) {
  const std::string here = room("digest.obj", true), folder = testing::TempDir() + "/elsewhere";
  std::filesystem::create_directories(folder);
  std::filesystem::copy_file(here, folder + "/digest.obj", std::filesystem::copy_options::overwrite_existing);
  const std::string digest = openScene({here, walk(), {}}).digest;
  EXPECT_EQ(digest, openScene({folder + "/digest.obj", walk(), {}}).digest);
  EXPECT_NE(digest, openScene({room("digest.obj", false), walk(), {}}).digest);
}

}  // namespace
}  // namespace sgraphs::simulate
