#include "backend/graph/situational_graph.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <set>

namespace sgraphs {
namespace {

SituationalGraph smallGraph() {
  SituationalGraph graph;
  for (int k = 0; k < 3; ++k) {
    KeyframeNode node;
    node.id = KeyframeId{k};
    node.time = Time{100LL * k};
    node.T_map_body.translation.x() = k;
    node.floor = FloorId{0};
    graph.keyframes.emplace(node.id, node);
  }
  graph.floors.emplace(FloorId{0}, FloorNode{.id = FloorId{0}});
  for (int k = 1; k < 3; ++k) {
    RelativePose z;
    z.from = KeyframeId{k - 1};
    z.to = KeyframeId{k};
    z.T_from_to.translation.x() = 1;
    graph.relative_poses.push_back({k, z});
  }
  graph.ups.push_back({3, KeyframeId{1}, Eigen::Vector3d::UnitZ(), 0.01});
  return graph;
}

TEST(SituationalGraphTest, DigestOfEqualGraphsIsEqual) {
  EXPECT_EQ(smallGraph().digest(), smallGraph().digest());
  EXPECT_EQ(smallGraph().digest().size(), 64U);
}

// A change of any number by one bit, of an id, a kind or a count shows.
TEST(SituationalGraphTest, DigestChangesWithEveryMember) {
  const auto bit = [](double& x) { x = std::nextafter(x, 10.0); };
  const KeyframeId k1{1};
  const std::vector<std::function<void(SituationalGraph&)>> changes = {
      [&](auto& g) { bit(g.keyframes.at(k1).T_map_body.translation.y()); },
      [&](auto& g) { bit(g.keyframes.at(k1).T_map_body.rotation.x()); },
      [&](auto& g) { bit(g.keyframes.at(k1).T_odom_body.translation.z()); },
      [&](auto& g) { g.keyframes.at(k1).time.us += 1; },
      [&](auto& g) { g.keyframes.at(k1).floor = FloorId{}; },
      [&](auto& g) { g.keyframes.erase(k1); },
      [&](auto& g) { bit(g.floors.at(FloorId{0}).z_m); },
      [&](auto& g) { g.floors.at(FloorId{0}).has_height = true; },
      [&](auto& g) { bit(g.floors.at(FloorId{0}).center_map.x()); },
      [&](auto& g) { bit(g.up_map.x()); },
      [&](auto& g) { g.relative_poses[0].id = 7; },
      [&](auto& g) { g.relative_poses[0].measurement.kind = RelativePoseKind::kLoop; },
      [&](auto& g) { g.relative_poses[0].measurement.to = KeyframeId{2}; },
      [&](auto& g) { bit(g.relative_poses[1].measurement.T_from_to.rotation.z()); },
      [&](auto& g) { bit(g.relative_poses[1].measurement.covariance(2, 4)); },
      [&](auto& g) { g.relative_poses.pop_back(); },
      [&](auto& g) { bit(g.ups[0].up_body.x()); },
      [&](auto& g) { bit(g.ups[0].sigma_rad); },
      [&](auto& g) { g.ups[0].keyframe = KeyframeId{2}; },
      [&](auto& g) { g.ups.clear(); }};
  std::set<std::string> digests{smallGraph().digest()};
  for (const auto& change : changes) {
    SituationalGraph graph = smallGraph();
    change(graph);
    digests.insert(graph.digest());
  }
  EXPECT_EQ(digests.size(), changes.size() + 1);
}

TEST(SituationalGraphTest, CheckPassesASoundGraph) {
  EXPECT_NO_THROW(smallGraph().check());
}

TEST(SituationalGraphTest, CheckFindsDanglingFactorsAndNumbersThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(SituationalGraph&)>> faults = {
      [&](auto& g) { g.keyframes.erase(KeyframeId{2}); },
      [&](auto& g) { g.ups[0].keyframe = KeyframeId{9}; },
      [&](auto& g) { g.keyframes.at(KeyframeId{1}).T_map_body.translation.x() = nan; },
      [&](auto& g) { g.keyframes.at(KeyframeId{1}).id = KeyframeId{2}; },
      [&](auto& g) { g.relative_poses[0].measurement.T_from_to.rotation.w() = nan; },
      [&](auto& g) { g.ups[0].sigma_rad = 0; },
      [&](auto& g) { g.floors.clear(); },
      [&](auto& g) { g.up_map *= 2.0; }};
  for (size_t i = 0; i < faults.size(); ++i) {
    SituationalGraph graph = smallGraph();
    faults[i](graph);
    EXPECT_THROW(graph.check(), std::logic_error) << "fault " << i;
  }
}

}  // namespace
}  // namespace sgraphs
