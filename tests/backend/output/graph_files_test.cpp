#include "backend/output/graph_files.h"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "backend/output/floor_level.h"
#include "tests/backend/output/synthetic_run.h"

namespace sgraphs {
namespace {

SE3 readPose(std::istream& in) {
  double v[7];
  for (double& x : v) in >> x;
  return {Eigen::Quaterniond(v[6], v[3], v[4], v[5]), {v[0], v[1], v[2]}};
}

// Sum of e^T Omega e with e as stock g2o forms it: translation and quaternion vector part (w >= 0) of
// Z^-1 Xi^-1 Xj.
double g2oChi2(const std::string& text) {
  std::map<int, SE3> vertices;
  double chi2 = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream row(line);
    std::string tag;
    row >> tag;
    int i = 0, j = 0;
    if (tag == "VERTEX_SE3:QUAT") {
      row >> i;
      vertices[i] = readPose(row);
    } else if (tag == "EDGE_SE3:QUAT") {
      row >> i >> j;
      const SE3 error = readPose(row).inverse() * vertices.at(i).inverse() * vertices.at(j);
      Vector6d e;
      e << error.translation, error.rotation.vec() * (error.rotation.w() < 0 ? -1 : 1);
      Matrix6d information;
      for (int r = 0; r < 6; ++r)
        for (int c = r; c < 6; ++c) {
          row >> information(r, c);
          information(c, r) = information(r, c);
        }
      chi2 += e.dot(information * e);
    }
    EXPECT_FALSE(row.fail() && tag[0] != '#') << line;
  }
  return chi2;
}

// Residuals small enough that g2o's and our tangent agree to first order, with correlated covariances.
SituationalGraph disturbedGraph() {
  auto run = test::makeSyntheticRun();
  SituationalGraph graph = run->graph;
  double sign = 1;
  for (auto& [id, node] : graph.keyframes) {
    Vector6d xi;
    xi << 2e-3, -1e-3, 3e-3, 1e-3, -2e-3, 2e-3;
    node.T_map_body = node.T_map_body * se3Exp(sign * xi);
    sign = -1.3 * sign / std::abs(sign);
  }
  for (auto& factor : graph.relative_poses) {
    Matrix6d& covariance = factor.measurement.covariance;
    covariance.bottomRightCorner<3, 3>() = Eigen::Vector3d(4e-6, 9e-6, 1e-6).asDiagonal();
    covariance(0, 5) = covariance(5, 0) = 5e-6;
  }
  return graph;
}

TEST(GraphFilesTest, G2oReproducesOurChi2) {
  const SituationalGraph graph = disturbedGraph();
  double chi2 = 0;
  for (const auto& factor : graph.relative_poses) {
    const RelativePose& m = factor.measurement;
    const Vector6d e = se3Log(m.T_from_to.inverse() * graph.keyframes.at(m.from).T_map_body.inverse() *
                              graph.keyframes.at(m.to).T_map_body);
    chi2 += e.dot(m.covariance.inverse() * e);
  }
  ASSERT_GT(chi2, 10);
  EXPECT_NEAR(g2oChi2(graphG2o(graph)), chi2, 0.01 * chi2);
}

TEST(GraphFilesTest, G2oFixesTheFirstVertexAndListsEveryEdge) {
  const SituationalGraph graph = disturbedGraph();
  const std::string text = graphG2o(graph);
  EXPECT_THAT(text, testing::HasSubstr("\nFIX 0\n"));
  size_t edges = 0;
  for (size_t at = text.find("\nEDGE_SE3:QUAT"); at != std::string::npos;
       at = text.find("\nEDGE_SE3:QUAT", at + 1))
    ++edges;
  EXPECT_EQ(edges, graph.relative_poses.size());
}

TEST(GraphFilesTest, SessionsOfAContinuedMapHaveTheirOwnClocks) {
  const auto run = test::makeSyntheticRun();
  const Time begin = run->graph.keyframes.at({10}).time;
  const std::vector<SessionClock> sessions = {{{0}, {0}, {}}, {{10}, begin, {7'000'000}}};
  const auto json = nlohmann::json::parse(graphJson(run->graph, {}, {}, sessions));
  EXPECT_EQ(json["nodes"][9]["session"], 0);
  EXPECT_EQ(json["nodes"][10]["session"], 1);
  EXPECT_EQ(json["nodes"][9]["utime"], run->graph.keyframes.at({9}).time.us);
  EXPECT_EQ(json["nodes"][10]["utime"], begin.us - 7'000'000);
}

TEST(GraphFilesTest, JsonFollowsTheSchema) {
  const auto run = test::makeSyntheticRun();
  const auto floors = describeFloors(run->graph, buildMap(run->graph, 0.05));
  const auto json = nlohmann::json::parse(graphJson(run->graph, floors));
  EXPECT_EQ(json["schema"], "sgraphs/1");
  EXPECT_EQ(json["directed"], false);
  EXPECT_EQ(json["multigraph"], true);
  ASSERT_EQ(json["nodes"].size(), 15u);
  const auto& k12 = json["nodes"][12];
  EXPECT_EQ(k12["id"], "k12");
  EXPECT_EQ(k12["layer"], "keyframes");
  EXPECT_EQ(k12["utime"], 1'700'000'012'000'000);
  EXPECT_EQ(k12["floor"], "f0");
  const SE3& T_map_body = run->graph.keyframes.at({12}).T_map_body;
  EXPECT_EQ(k12["T_map_body"]["xyz"][1], T_map_body.translation.y());
  EXPECT_EQ(k12["T_map_body"]["qxyzw"][3], T_map_body.rotation.w());
  const auto& f0 = json["nodes"][14];
  EXPECT_EQ(f0["id"], "f0");
  EXPECT_EQ(f0["layer"], "floors");
  EXPECT_NEAR(f0["z"], -0.5, 0.01);
  ASSERT_EQ(json["links"].size(), 13u);
  const auto& link = json["links"][11];
  EXPECT_EQ(link["source"], "k11");
  EXPECT_EQ(link["target"], "k12");
  EXPECT_EQ(link["kind"], "odometry");
  ASSERT_EQ(link["covariance"].size(), 21u);
  EXPECT_EQ(link["covariance"][0], 1e-4);
  EXPECT_EQ(link["covariance"][5], 2e-5);  // row 0, column 5
}

TEST(GraphFilesTest, UnknownHeightIsNull) {
  const auto run = test::makeSyntheticRun();
  const auto json =
      nlohmann::json::parse(graphJson(run->graph, {{FloorId{0}, FloorNode{{0}, {0, 0}, false, 0}}}));
  EXPECT_TRUE(json["nodes"].back()["z"].is_null());
}

}  // namespace
}  // namespace sgraphs
