// The backend with planes, on a ring of corridors with exact truth.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <set>

#include "backend/backend.h"
#include "backend/planes/plane_residual.h"
#include "tests/backend/planes/ring_walk.h"

namespace sgraphs {
namespace {

using testing_support::Face;
using testing_support::makeRingWalk;
using testing_support::noisy;
using testing_support::RingWalk;

struct WholeRun {
  Backend backend{BackendConfig{}};
  RoundOutput newest;
  double ate_m = 0;

  explicit WholeRun(const RingWalk& walk, bool with_planes = true) {
    int64_t round = 0;
    for (size_t k = 0; k < walk.keyframes.size(); ++k) {
      RoundInput input{.round = round++, .time = walk.keyframes[k].time, .keyframe = walk.keyframes[k]};
      if (with_planes) input.planes = walk.planes[k];
      newest = backend.step(std::move(input));
    }
    for (int i = 0; i < 3; ++i)
      newest = backend.step({.round = round++, .time = walk.keyframes.back().time, .keyframe = {}});
    backend.graph().check();
    Eigen::Matrix3Xd estimated(3, walk.truth.size()), truth(3, walk.truth.size());
    for (const auto& [id, node] : backend.graph().keyframes) {
      estimated.col(id.value) = node.T_map_body.translation;
      truth.col(id.value) = walk.truth[static_cast<size_t>(id.value)].translation;
    }
    const Eigen::Isometry3d aligned(Eigen::umeyama(estimated, truth, false));
    ate_m = std::sqrt((aligned * estimated - truth).colwise().squaredNorm().mean());
  }
  const SituationalGraph& graph() const { return backend.graph(); }
};

std::multiset<std::string> labels(const SituationalGraph& graph) {
  std::multiset<std::string> all;
  for (const auto& [id, plane] : graph.planes) all.insert(toString(plane.label));
  return all;
}

TEST(BackendPlanesTest, EveryFaceIsOnePlaneAndTheLapCloses) {
  const RingWalk walk = makeRingWalk({});
  const WholeRun with(walk), without(walk, false);
  EXPECT_EQ(with.graph().planes.size(), walk.faces.size());
  EXPECT_LT(with.ate_m, 0.02);
  EXPECT_LT(with.ate_m, 0.3 * without.ate_m);
  for (const auto& item : with.graph().planes) {
    const auto& plane = item.second;
    const auto of = std::find_if(walk.faces.begin(), walk.faces.end(), [&](const Face& face) {
      const Eigen::Vector3d normal = walk.T_map_world().rotation * face.normal;
      const Eigen::Vector3d centre = walk.T_map_world() * face.centre;
      return normal.dot(plane.normal_map) > 0.999 && std::abs(plane.distance(centre)) < 0.05;
    });
    EXPECT_NE(of, walk.faces.end()) << item.first.str();
  }
}

TEST(BackendPlanesTest, EveryKindOfFactorReachesTheSolver) {
  const WholeRun run(makeRingWalk({}));
  const auto statistics = run.backend.factorStatistics();
  const SituationalGraph& graph = run.graph();
  EXPECT_EQ(statistics.at("observes").count, static_cast<int64_t>(graph.observations.size()));
  EXPECT_EQ(statistics.at("plane_up").count, static_cast<int64_t>(graph.planes.size()));
  for (const char* kind : {"odometry", "observes", "plane_up"}) {
    EXPECT_GT(statistics.at(kind).chi2, 0) << kind;
    EXPECT_LT(statistics.at(kind).chi2, 1.3 * static_cast<double>(statistics.at(kind).dof)) << kind;
  }
}

// Independent noise of known size: the stated covariances must be true, of poses and of planes.
TEST(BackendPlanesTest, CovariancesAreCalibrated) {
  double pose_nees = 0, plane_nees = 0, num_poses = 0, num_planes = 0;
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    const RingWalk walk = makeRingWalk({.seed = seed});
    const WholeRun run(walk);
    for (const auto& [id, covariance] : run.backend.keyframeCovariances()) {
      if (covariance.isZero()) continue;  // the first, which defines the map
      const SE3 truth = walk.T_map_world() * walk.truth[static_cast<size_t>(id.value)];
      const Vector6d error = se3Log(run.graph().keyframes.at(id).T_map_body.inverse() * truth);
      pose_nees += error.dot(covariance.inverse() * error);
      num_poses += 1;
    }
    for (const auto& [id, plane] : run.graph().planes)
      for (const Face& face : walk.faces) {
        const Eigen::Vector3d normal = walk.T_map_world().rotation * face.normal;
        const Eigen::Vector3d centre = walk.T_map_world() * face.centre;
        if (normal.dot(plane.normal_map) < 0.99 || std::abs(plane.distance(centre)) > 0.1) continue;
        Eigen::Vector3d error;
        error << tangentBasis(plane.normal_map).transpose() * normal, normal.dot(centre - plane.centroid_map);
        plane_nees += error.dot(plane.covariance.inverse() * error);
        num_planes += 1;
      }
  }
  EXPECT_NEAR(pose_nees / num_poses, 6.0, 3.0);
  EXPECT_NEAR(plane_nees / num_planes, 3.0, 1.5);
  EXPECT_EQ(num_planes, 60);
}

// Mistake 6 of earlier systems: the start heading must not matter.
TEST(BackendPlanesTest, AnyStartHeadingGivesTheSameWalls) {
  const WholeRun straight(makeRingWalk({}));
  for (const double degrees : {30.0, 45.0, 90.0, -137.0}) {
    const WholeRun run(makeRingWalk({.start_heading_rad = degrees * M_PI / 180}));
    EXPECT_EQ(run.graph().planes.size(), straight.graph().planes.size()) << degrees;
    EXPECT_EQ(labels(run.graph()).count("horizontal"), 2u);
    EXPECT_EQ(labels(run.graph()).count("x"), 4u);
    EXPECT_NEAR(run.ate_m, straight.ate_m, 0.01) << degrees;
  }
}

TEST(BackendPlanesTest, AWallOneDegreeOffSquareStaysOff) {
  const double off = M_PI / 180;
  const RingWalk walk = makeRingWalk({.wall_off_square_rad = off});
  const WholeRun run(walk);
  const Eigen::Vector3d truth = walk.T_map_world().rotation * walk.faces[0].normal;
  double best = 10;
  for (const auto& [id, plane] : run.graph().planes)
    best = std::min(best, std::acos(std::min(1.0, plane.normal_map.dot(truth))));
  EXPECT_LT(best, 0.2 * off);
  EXPECT_LT(run.ate_m, 0.02);
}

TEST(BackendPlanesTest, TheSameInputGivesTheSameDigest) {
  const RingWalk walk = makeRingWalk({});
  EXPECT_EQ(WholeRun(walk).newest.graph_digest, WholeRun(walk).newest.graph_digest);
}

TEST(BackendPlanesTest, ASurfaceSeenOnceIsNotMapped) {
  RingWalk walk = makeRingWalk({.laps = 0.2});
  PlaneObservation person = walk.planes[5].planes[0];
  person.centroid_body += 0.7 * person.normal_body;
  walk.planes[5].planes.push_back(person);
  const size_t num_planes = WholeRun(makeRingWalk({.laps = 0.2})).graph().planes.size();
  EXPECT_EQ(WholeRun(walk).graph().planes.size(), num_planes);
}

// Two pieces of a wall are mapped apart; once what lies between is seen they are one, and nothing is lost.
TEST(BackendPlanesTest, PiecesThatGrowTogetherAreMerged) {
  RingWalk walk = makeRingWalk({.laps = 0.2});
  const Face wall{{9, 0, 1.3}, {-1, 0, 0}, 6, 1.3};
  const size_t n = walk.keyframes.size();
  ASSERT_GE(n, 12u);
  std::mt19937 random(4);
  for (size_t k = 0; k < n; ++k) {
    Face left = wall, right = wall;
    left.centre.y() = -4;
    right.centre.y() = 4;
    left.half_width_m = right.half_width_m = 1.5;
    walk.planes[k].planes.clear();
    const SE3& T = walk.truth[k];
    if (k < n / 2) {
      walk.planes[k].planes = {noisy(observe(left, T), random), noisy(observe(right, T), random)};
    } else {
      walk.planes[k].planes = {noisy(observe(wall, T), random)};
    }
  }
  const WholeRun run(walk);
  EXPECT_EQ(run.graph().planes.size(), 1u);
  EXPECT_EQ(run.graph().merged_planes.size(), 1u);
  EXPECT_EQ(run.graph().observations.size(), 2 * (n / 2) + n - n / 2);
  EXPECT_EQ(run.graph().planes.begin()->second.num_observations,
            static_cast<int64_t>(run.graph().observations.size()));
}

// Messages may say anything finite: what no solver can weigh is left out and named, and the rest goes on.
TEST(BackendPlanesTest, PlanesThatCannotBeWeighedAreNamedAndLeftOut) {
  RingWalk walk = makeRingWalk({.laps = 0.2});
  walk.planes[3].planes[0].covariance = 1e-300 * Eigen::Matrix3d::Identity();
  walk.planes[4].planes[0].centroid_body.x() = 1e12;
  walk.planes[5].pose_sigma.setConstant(1e100);
  Backend backend{BackendConfig{}};
  std::vector<std::string> refused;
  for (size_t k = 0; k < walk.keyframes.size(); ++k) {
    const RoundOutput output = backend.step({.round = static_cast<int64_t>(k),
                                             .time = walk.keyframes[k].time,
                                             .keyframe = walk.keyframes[k],
                                             .planes = walk.planes[k]});
    refused.insert(refused.end(), output.refused.begin(), output.refused.end());
  }
  backend.graph().check();
  EXPECT_GE(refused.size(), 2 + walk.planes[5].planes.size());
  EXPECT_NE(refused.front().find("plane 0 of keyframe k3"), std::string::npos) << refused.front();
  const SE3 last = backend.graph().keyframes.rbegin()->second.T_map_body;
  EXPECT_LT((last.translation - (walk.T_map_world() * walk.truth.back()).translation).norm(), 0.2);
}

// Keyframes at these places, level, looking along x; every face whose visible side they are on is seen whole.
RingWalk walkAmong(const std::vector<Face>& faces, const std::vector<Eigen::Vector3d>& places,
                   uint32_t seed) {
  RingWalk walk;
  walk.faces = faces;
  std::mt19937 random(seed);
  for (size_t k = 0; k < places.size(); ++k) {
    walk.truth.emplace_back(Eigen::Quaterniond::Identity(), places[k]);
    Keyframe keyframe;
    keyframe.id = KeyframeId{static_cast<int64_t>(k)};
    keyframe.time = Time{1'000'000 * (static_cast<int64_t>(k) + 1)};
    if (k > 0) {
      RelativePose z;
      z.from = KeyframeId{keyframe.id.value - 1};
      z.to = keyframe.id;
      z.T_from_to = walk.truth[k - 1].inverse() * walk.truth[k];
      z.covariance = 1e-4 * Matrix6d::Identity();
      keyframe.relative_poses.push_back(z);
    }
    KeyframePlanes planes{.keyframe = keyframe.id, .time = keyframe.time, .planes = {}};
    for (const Face& face : faces)
      if (face.normal.dot(places[k] - face.centre) > 0)
        planes.planes.push_back(noisy(observe(face, walk.truth[k]), random));
    walk.keyframes.push_back(std::move(keyframe));
    walk.planes.push_back(std::move(planes));
  }
  return walk;
}

std::vector<Eigen::Vector3d> line(const Eigen::Vector3d& from, const Eigen::Vector3d& to, int n) {
  std::vector<Eigen::Vector3d> places;
  places.reserve(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) places.emplace_back(from + (to - from) * i / (n - 1));
  return places;
}

// Nothing makes a room square that is not.
TEST(BackendPlanesTest, ATrapezoidStaysATrapezoid) {
  const double slant = 12 * M_PI / 180;
  const std::vector<Face> faces{{{4, 0, 0.5}, {-1, 0, 0}},
                                {{-4, 0, 0.5}, {1, 0, 0}},
                                {{0, 3, 0.5}, {std::sin(slant), -std::cos(slant), 0}, 4},
                                {{0, -3, 0.5}, {0, 1, 0}, 4},
                                {{0, 0, -0.6}, {0, 0, 1}, 3, 3}};
  const WholeRun run(walkAmong(faces, line({-2, 0, 0}, {2, 0.5, 0}, 12), 5));
  ASSERT_EQ(run.graph().planes.size(), faces.size());
  for (const Face& face : faces) {
    double best = 1;
    for (const auto& [id, plane] : run.graph().planes)
      best = std::min(best, (plane.normal_map - face.normal).norm());
    EXPECT_LT(best, 0.006);
  }
}

// A wall 5 cm thick, walked around: two faces at their distance, tied by one factor.
TEST(BackendPlanesTest, AThinWallIsTwoFacesAtItsThickness) {
  const std::vector<Face> faces{{{0.025, 0, 0.5}, {1, 0, 0}, 2},
                                {{-0.025, 0, 0.5}, {-1, 0, 0}, 2},
                                {{0, 6, 0.5}, {0, -1, 0}, 5},
                                {{0, 0, -0.6}, {0, 0, 1}, 5, 5}};
  std::vector<Eigen::Vector3d> places = line({2, -2, 0}, {2, 3, 0}, 8);
  for (const Eigen::Vector3d& p : line({1.5, 3.5, 0}, {-1.5, 3.5, 0}, 5)) places.push_back(p);
  for (const Eigen::Vector3d& p : line({-2, 3, 0}, {-2, -2, 0}, 8)) places.push_back(p);
  const WholeRun run(walkAmong(faces, places, 6));
  ASSERT_EQ(run.graph().planes.size(), faces.size());
  ASSERT_EQ(run.graph().faces.size(), 1u);
  const PlaneNode& a = run.graph().planes.at(run.graph().faces[0].a);
  const PlaneNode& b = run.graph().planes.at(run.graph().faces[0].b);
  EXPECT_NEAR(-a.distance(b.centroid_map), 0.05, 0.01);
}

}  // namespace
}  // namespace sgraphs
