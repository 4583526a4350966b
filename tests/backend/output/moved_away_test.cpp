#include "backend/output/moved_away.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace sgraphs {
namespace {

constexpr double kBody_m = 0.5;  // over the floor, which is at z = -0.5

// A room of about 6 x 6 m around the origin, seen from a body at (x, 0); the LiDAR is 0.3 m above it.
// `visitor`: somebody stands at (1.5, 1), seen from the front. A post of 5 cm stands at (-1.5, 1).
std::shared_ptr<const Keyframe> viewFrom(int64_t id, double x, bool visitor) {
  auto keyframe = std::make_shared<Keyframe>();
  keyframe->id = {id};
  keyframe->time = Time{1'000'000 * (id + 1)};
  keyframe->T_keyframe_body = {SE3()};
  keyframe->T_body_lidar = SE3(Eigen::Quaterniond::Identity(), {0, 0, 0.3});
  const auto add = [&](double px, double py, double height) {
    keyframe->points.push_back(
        {{static_cast<float>(px - x), static_cast<float>(py), static_cast<float>(height - kBody_m)}, 0, 1});
  };
  for (double along = -2.95; along < 2.95; along += 0.05) {
    for (double height = 0.05; height < 4; height += 0.05) {
      add(along, 2.96, height);
      add(along, -2.96, height);
      add(2.96, along, height);
      add(-2.96, along, height);
    }
    for (double y = -2.95; y < 2.95; y += 0.05) add(along, y, 0);
  }
  for (double height = 0.2; height < 1.95; height += 0.05) {
    for (double across = -0.2; visitor && across < 0.2; across += 0.04) add(1.5 + across, 0.96, height);
    add(-1.5, 1, height);
  }
  return keyframe;
}

SituationalGraph roomSeenBy(int keyframes, int visits) {
  SituationalGraph graph;
  graph.floors[{0}].id = {0};
  for (int64_t id = 0; id < keyframes; ++id) {
    KeyframeNode node;
    node.id = {id};
    node.floor = {0};
    const double x = 0.3 * static_cast<double>(id) - 1;
    node.T_map_body.translation = {x, 0, 0};
    node.keyframe = viewFrom(id, x, id < visits);
    node.time = node.keyframe->time;
    graph.keyframes[node.id] = node;
  }
  return graph;
}

size_t countNear(const std::vector<MapPoint>& map, const Eigen::Vector2f& place, float from_z = -0.35F) {
  size_t count = 0;
  for (const MapPoint& p : map)
    count += (p.position_map.head<2>() - place).norm() < 0.3F && p.position_map.z() > from_z;
  return count;
}

TEST(MovedAwayTest, WhoStoodThereOnceIsGoneAndWhatStandsStays) {
  const SituationalGraph graph = roomSeenBy(8, 1);
  std::vector<MapPoint> map = buildMap(graph, 0.05);
  const size_t visitor = countNear(map, {1.5F, 1}), post = countNear(map, {-1.5F, 1}), all = map.size();
  ASSERT_GT(visitor, 200u);
  ASSERT_GT(post, 25u);
  MovedAway(graph).dropFrom(map);
  EXPECT_LT(countNear(map, {1.5F, 1}), visitor / 4);
  EXPECT_EQ(countNear(map, {1.5F, 1}, 1.25F), 0u) << "a head at 1.75 m and more";
  EXPECT_EQ(countNear(map, {-1.5F, 1}), post) << "thin, but there every time";
  EXPECT_GT(map.size(), all - visitor - all / 200) << "walls and floor stay";
}

TEST(MovedAwayTest, WhoStoodThereMostOfTheTimeStays) {
  const SituationalGraph graph = roomSeenBy(8, 5);
  std::vector<MapPoint> map = buildMap(graph, 0.05);
  const size_t visitor = countNear(map, {1.5F, 1});
  MovedAway(graph).dropFrom(map);
  EXPECT_GT(countNear(map, {1.5F, 1}), 8 * visitor / 10);
}

TEST(MovedAwayTest, TwoLooksAreNotEnoughToCallSomethingGone) {
  const SituationalGraph graph = roomSeenBy(3, 1);
  std::vector<MapPoint> map = buildMap(graph, 0.05);
  const size_t visitor = countNear(map, {1.5F, 1});
  MovedAway(graph).dropFrom(map);
  EXPECT_GT(countNear(map, {1.5F, 1}), 8 * visitor / 10);
}

// A wall face in the plane y = y_m that looks at the robot, of `observations` keyframes.
PlaneNode faceAt(int64_t id, double x_m, double y_m, double half_width_m, int64_t observations) {
  PlaneNode plane;
  plane.id = {id};
  plane.floor = {0};
  plane.label = PlaneLabel::kY;
  plane.normal_map = -Eigen::Vector3d::UnitY();
  plane.centroid_map = plane.anchor_map = {x_m, y_m, 0.5};
  plane.num_observations = observations;
  for (const auto& [across, up] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
    plane.polygon_map.emplace_back(x_m + across * half_width_m, y_m, 0.5 + 0.6 * up);
  return plane;
}

SituationalGraph withFaces(SituationalGraph graph, const std::vector<PlaneNode>& faces) {
  int64_t factor = 0;
  for (const PlaneNode& face : faces) {
    graph.planes[face.id] = face;
    graph.observations.push_back({factor++, {0}, face.id, {}});
    graph.plane_ups.push_back({factor++, face.id, false, 0.01});
  }
  return graph;
}

TEST(MovedAwayTest, AWallThatWasSomebodyWalkedPast) {
  const SituationalGraph graph =
      withFaces(roomSeenBy(8, 1), {faceAt(1, 1.5, 0.96, 0.2, 1), faceAt(2, 0.0, 2.96, 2.5, 2)});
  EXPECT_EQ(MovedAway(graph).whoWalkedPast(graph), std::set<PlaneId>({{1}})) << "w2 stands";
}

TEST(MovedAwayTest, AWallSeenFromManyPlacesOrOfARoomStays) {
  SituationalGraph graph =
      withFaces(roomSeenBy(8, 1), {faceAt(1, 1.5, 0.96, 0.2, 4), faceAt(2, 1.5, 0.96, 0.2, 1)});
  graph.rooms[{7}].id = {7};
  graph.rooms[{7}].seen.pairs = {{{2}, {1}}};
  EXPECT_TRUE(MovedAway(graph).whoWalkedPast(graph).empty()) << "a pane lets rays pass, too";
}

}  // namespace
}  // namespace sgraphs
