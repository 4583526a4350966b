#include <gmock/gmock.h>

#include <Eigen/LU>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "backend/output/graph_files.h"
#include "tests/backend/output/synthetic_planes.h"

namespace sgraphs {
namespace {

// Our residual of a plane seen from a keyframe: the tilts and the offset that the measurement misses.
Eigen::Vector3d ourError(const PlaneObservation& z, const SE3& T_map_body, const PlaneNode& plane) {
  const Eigen::Vector3d n_body = T_map_body.rotation.conjugate() * plane.normal_map;
  Eigen::Vector3d e;
  e << tangentBasis(z.normal_body).transpose() * n_body, -plane.distance(T_map_body * z.centroid_body);
  return e;
}

// A plane as stock g2o holds it, (n, d) with n.p + d = 0, with its rotation that brings x onto the normal.
struct FormatPlane {
  Eigen::Vector3d n;
  double d = 0;

  FormatPlane seenIn(const SE3& T_map_frame) const {
    const SE3 T_frame_map = T_map_frame.inverse();
    const Eigen::Vector3d turned = T_frame_map.rotation * n;
    return {turned, d - T_frame_map.translation.dot(turned)};
  }
  // Azimuth and elevation of the other normal where this one is (1, 0, 0), and this distance less the other.
  Eigen::Vector3d minus(const FormatPlane& other) const {
    const double azimuth = std::atan2(n.y(), n.x()), elevation = std::atan2(n.z(), std::hypot(n.x(), n.y()));
    const Eigen::Vector3d m = Eigen::AngleAxisd(elevation, Eigen::Vector3d::UnitY()) *
                              (Eigen::AngleAxisd(-azimuth, Eigen::Vector3d::UnitZ()) * other.n);
    return {std::atan2(m.y(), m.x()), std::atan2(m.z(), std::hypot(m.x(), m.y())), other.d - d};
  }
};

// Reads the file as stock g2o does: every row needs all its fields, and ids are those of vertices before.
struct Loaded {
  std::map<int, SE3> poses;
  std::map<int, FormatPlane> planes;
  std::set<int> fixed;
  size_t num_plane_edges = 0;
  double plane_chi2 = 0;

  explicit Loaded(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream row(line);
      std::string tag;
      row >> tag;
      if (tag == "VERTEX_SE3:QUAT") readPoseVertex(row, line);
      if (tag == "VERTEX_PLANE") readPlaneVertex(row, line);
      if (tag == "EDGE_SE3_PLANE_CALIB") readPlaneEdge(row, line);
      if (tag == "FIX")
        for (int id; row >> id;) fixed.insert(id);
    }
  }

 private:
  static FormatPlane readPlane(std::istream& row) {
    FormatPlane plane;
    double color;
    row >> plane.n.x() >> plane.n.y() >> plane.n.z() >> plane.d >> color >> color >> color;
    plane.d /= plane.n.norm();
    plane.n.normalize();
    return plane;
  }
  bool isNew(int id) const { return !poses.contains(id) && !planes.contains(id); }

  void readPoseVertex(std::istream& row, const std::string& line) {
    int id = -1;
    double v[7];
    row >> id;
    for (double& x : v) row >> x;
    EXPECT_TRUE(row && isNew(id)) << line;
    poses[id] = {Eigen::Quaterniond(v[6], v[3], v[4], v[5]), {v[0], v[1], v[2]}};
  }
  void readPlaneVertex(std::istream& row, const std::string& line) {
    int id = -1;
    row >> id;
    const FormatPlane plane = readPlane(row);
    EXPECT_TRUE(row && isNew(id)) << line;
    planes[id] = plane;
  }
  void readPlaneEdge(std::istream& row, const std::string& line) {
    int body = -1, plane = -1, offset = -1;
    row >> body >> plane >> offset;
    const FormatPlane measured = readPlane(row);
    Eigen::Matrix3d information;
    for (int r = 0; r < 3; ++r)
      for (int c = r; c < 3; ++c) {
        row >> information(r, c);
        information(c, r) = information(r, c);
      }
    std::string rest;
    EXPECT_TRUE(row && !(row >> rest)) << line;
    EXPECT_TRUE(fixed.contains(offset)) << "the sensor's offset is no state of ours: " << line;
    const FormatPlane predicted = planes.at(plane).seenIn(poses.at(body) * poses.at(offset));
    const Eigen::Vector3d e = predicted.minus(measured);
    plane_chi2 += e.dot(information * e);
    ++num_plane_edges;
  }
};

// Bodies tilted in all directions and planes off by millimetres and milliradians.
SituationalGraph disturbedRoom() {
  auto run = test::makeSyntheticRun();
  SituationalGraph graph = run->graph;
  int i = 0;
  for (auto& [id, node] : graph.keyframes) {
    Vector6d tilt;
    tilt << 0.1, -0.2, 0.1, 0.2 * std::sin(1.0 + i), 0.3 * std::cos(2.0 * i), 0.4 * std::sin(3.0 * i);
    node.T_map_body = node.T_map_body * se3Exp(tilt);
    ++i;
  }
  test::addRoomPlanes(run->room, graph);
  for (auto& [id, node] : graph.keyframes) {
    Vector6d xi;
    xi << 2e-3, -1e-3, 3e-3, 1e-3, -2e-3, 2e-3;
    node.T_map_body = node.T_map_body * se3Exp(i++ % 2 ? xi : Vector6d(-1.3 * xi));
  }
  for (auto& [id, plane] : graph.planes) {
    const TangentBasis uv = tangentBasis(plane.normal_map);
    plane.normal_map = (plane.normal_map + 1e-3 * uv.col(0) - 2e-3 * uv.col(1)).normalized();
    plane.offset_m = 3e-3;
  }
  return graph;
}

TEST(GraphPlanesTest, G2oReproducesOurChi2OfPlanes) {
  const SituationalGraph graph = disturbedRoom();
  double chi2 = 0;
  std::map<PlaneId, double> of_plane;
  for (const ObservationFactor& factor : graph.observations) {
    const Eigen::Vector3d e = ourError(factor.measurement, graph.keyframes.at(factor.keyframe).T_map_body,
                                       graph.planes.at(factor.plane));
    chi2 += e.dot(factor.measurement.covariance.inverse() * e);
    of_plane[factor.plane] += e.dot(factor.measurement.covariance.inverse() * e);
  }
  ASSERT_GT(chi2, 50);
  const Loaded loaded(graphG2o(graph));
  EXPECT_EQ(loaded.num_plane_edges, graph.observations.size());
  EXPECT_NEAR(loaded.plane_chi2, chi2, 0.02 * chi2);
  // Each plane by itself, level ones included: azimuth must not be taken near a pole.
  for (const auto& of : of_plane) {
    const PlaneId id = of.first;
    SituationalGraph one = graph;
    std::erase_if(one.observations, [&](const ObservationFactor& f) { return f.plane != id; });
    EXPECT_NEAR(Loaded(graphG2o(one)).plane_chi2, of.second, 0.03 * of.second) << id.str();
  }
}

TEST(GraphPlanesTest, G2oPlanesAreThoseOfTheGraphAndIdsAreUnique) {
  const SituationalGraph graph = disturbedRoom();
  const Loaded loaded(graphG2o(graph));
  ASSERT_EQ(loaded.planes.size(), graph.planes.size());
  EXPECT_EQ(loaded.poses.size(), graph.keyframes.size() + 2);
  EXPECT_EQ(loaded.fixed.size(), 3u);
  EXPECT_TRUE(loaded.fixed.contains(0));
  auto read = loaded.planes.begin();
  for (const auto& [id, plane] : graph.planes) {
    EXPECT_NEAR((read->second.n - plane.normal_map).norm(), 0, 1e-12);
    EXPECT_NEAR(read->second.d, plane.d(), 1e-12);
    EXPECT_EQ(read->first, 14 + id.value);
    ++read;
  }
}

Eigen::Vector3d vectorOf(const nlohmann::json& json) {
  return Eigen::Vector3d(json[0].get<double>(), json[1].get<double>(), json[2].get<double>());
}

TEST(GraphPlanesTest, JsonWallsFollowTheSchema) {
  const SituationalGraph graph = disturbedRoom();
  const auto json = nlohmann::json::parse(graphJson(graph, graph.floors));
  ASSERT_EQ(json["nodes"].size(), 14u + 6u + 1u);
  const auto& w1 = json["nodes"][15];
  EXPECT_EQ(w1["id"], "w1");
  EXPECT_EQ(w1["layer"], "walls");
  EXPECT_EQ(w1["label"], "x");
  EXPECT_EQ(w1["floor"], "f0");
  EXPECT_EQ(json["nodes"][17]["label"], "y");
  EXPECT_EQ(json["nodes"][19]["label"], "horizontal");
  const PlaneNode& plane = graph.planes.at({1});
  EXPECT_EQ(vectorOf(w1["normal"]), plane.normal_map);
  // The plane was moved by 3 mm since the extent's centre was found: the centre goes with it.
  EXPECT_NEAR((vectorOf(w1["centroid"]) - plane.centroid_map + 3e-3 * plane.normal_map).norm(), 0, 1e-12);
  EXPECT_EQ(w1["d"], plane.d());
  ASSERT_EQ(w1["polygon"].size(), 4u);
  EXPECT_EQ(vectorOf(w1["polygon"][2]), plane.polygon_map[2]);
  EXPECT_EQ(w1["covariance"], nlohmann::json({1e-6, 0.0, 1e-6, 4e-6, 0.0, 9e-6}));
}

// The covariance's first number belongs to a turn about axes.u, its second to one about axes.v.
TEST(GraphPlanesTest, JsonAxesAreWhatTiltsTurnAbout) {
  const SituationalGraph graph = disturbedRoom();
  const auto json = nlohmann::json::parse(graphJson(graph, graph.floors));
  for (const auto& [id, plane] : graph.planes) {
    const auto& axes = json["nodes"][14 + static_cast<size_t>(id.value)]["axes"];
    const Eigen::Vector3d u = vectorOf(axes["u"]), v = vectorOf(axes["v"]);
    const TangentBasis basis = tangentBasis(plane.normal_map);
    EXPECT_NEAR((u.cross(v) - plane.normal_map).norm(), 0, 1e-12);
    const double tilt = 1e-4;
    const Eigen::Vector3d about_u = Eigen::AngleAxisd(tilt, u) * plane.normal_map;
    const Eigen::Vector3d about_v = Eigen::AngleAxisd(tilt, v) * plane.normal_map;
    EXPECT_NEAR((about_u - plane.normal_map - tilt * basis.col(0)).norm(), 0, 1e-8);
    EXPECT_NEAR((about_v - plane.normal_map - tilt * basis.col(1)).norm(), 0, 1e-8);
  }
}

TEST(GraphPlanesTest, JsonLinksKeyframesToWallsAndFacesToEachOther) {
  const SituationalGraph graph = disturbedRoom();
  const auto json = nlohmann::json::parse(graphJson(graph, graph.floors));
  // Four of the planes are walls of the only storey.
  constexpr size_t kFaces = 13 + 14 * 6;
  ASSERT_EQ(json["links"].size(), kFaces + 1 + 4);
  EXPECT_EQ(json["links"][13], nlohmann::json({{"source", "k0"}, {"target", "w0"}, {"kind", "observes"}}));
  EXPECT_EQ(json["links"][kFaces], nlohmann::json({{"source", "w0"}, {"target", "w1"}, {"kind", "faces"}}));
  for (size_t i = kFaces + 1; i < json["links"].size(); ++i) {
    EXPECT_EQ(json["links"][i]["kind"], "floor_wall");
    EXPECT_EQ(json["links"][i]["source"], "f0");
  }
}

TEST(GraphPlanesTest, JsonKeyframesCarryTheirCovarianceWhereItIsKnown) {
  const auto run = test::makeSyntheticRun();
  Matrix6d covariance = Matrix6d::Identity();
  covariance(0, 5) = covariance(5, 0) = 0.25;
  covariance(5, 5) = 7;
  const auto json =
      nlohmann::json::parse(graphJson(run->graph, {{{0}, FloorNode{{0}}}}, {{{3}, covariance}}));
  const auto& k3 = json["nodes"][3];
  ASSERT_EQ(k3["covariance"].size(), 21u);
  EXPECT_EQ(k3["covariance"][5], 0.25);
  EXPECT_EQ(k3["covariance"][20], 7);
  EXPECT_FALSE(json["nodes"][4].contains("covariance"));
}

}  // namespace
}  // namespace sgraphs
