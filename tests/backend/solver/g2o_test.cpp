// Public pose graphs as a check of the whole-graph solve against answers that are not ours: the optimum of
// SE-Sync (Rosen et al., IJRR 2019, table 1) and an evaluation of the residuals by matrix logarithms.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <ostream>
#include <sstream>
#include <unsupported/Eigen/MatrixFunctions>

#include "backend/factors/relative_pose_cost.h"
#include "backend/solver/incremental_solver.h"

namespace sgraphs {
namespace {

struct Edge {
  int from = 0;
  int to = 0;
  SE3 T_from_to;
  Matrix6d information = Matrix6d::Zero();
};

struct G2oFile {
  std::map<int, SE3> vertices;
  std::vector<Edge> edges;
};

SE3 readPose(std::istream& in) {
  SE3 T;
  in >> T.translation.x() >> T.translation.y() >> T.translation.z();
  in >> T.rotation.x() >> T.rotation.y() >> T.rotation.z() >> T.rotation.w();
  T.rotation.normalize();
  return T;
}

G2oFile readG2o(const std::string& path) {
  G2oFile file;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    std::istringstream text(line);
    std::string tag;
    text >> tag;
    if (tag == "VERTEX_SE3:QUAT") {
      int id = 0;
      text >> id;
      file.vertices[id] = readPose(text);
    } else if (tag == "EDGE_SE3:QUAT") {
      Edge edge;
      text >> edge.from >> edge.to;
      edge.T_from_to = readPose(text);
      for (int r = 0; r < 6; ++r)
        for (int c = r; c < 6; ++c) {
          text >> edge.information(r, c);
          edge.information(c, r) = edge.information(r, c);
        }
      file.edges.push_back(edge);
    }
    EXPECT_FALSE(text.fail()) << line;
  }
  return file;
}

Eigen::Matrix4d matrix4(const SE3& T) {
  Eigen::Matrix4d M = Eigen::Matrix4d::Identity();
  M.topLeftCorner<3, 3>() = T.matrix3();
  M.topRightCorner<3, 1>() = T.translation;
  return M;
}

// SE-Sync weighs translation and rotation of an edge by one number each: the mean of the variances.
Matrix6d isotropicCovariance(const Matrix6d& information) {
  const Eigen::Matrix3d translation = information.topLeftCorner<3, 3>().inverse();
  const Eigen::Matrix3d rotation = information.bottomRightCorner<3, 3>().inverse();
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(translation.trace() / 3.0),
      Eigen::Vector3d::Constant(rotation.trace() / 3.0);
  return variances.asDiagonal();
}

// chi2 from the logarithm of the 4 x 4 matrix of the error, which shares no code with the solver's.
double independentChi2(const Edge& edge, const SE3& Xi, const SE3& Xj) {
  const Eigen::Matrix4d E = matrix4(edge.T_from_to).inverse() * matrix4(Xi).inverse() * matrix4(Xj);
  const Eigen::Matrix4d L = E.log();
  Vector6d xi;
  xi << L(0, 3), L(1, 3), L(2, 3), L(2, 1), L(0, 2), L(1, 0);
  return xi.dot(isotropicCovariance(edge.information).inverse() * xi);
}

struct Benchmark {
  const char* name;
  double se_sync_optimum;  // of the chordal cost, which agrees with ours up to the third order of the error
  double tolerance;
};
// GoogleTest would print the bytes, an address among them, and CTest would take them into the test's name.
void PrintTo(const Benchmark& benchmark, std::ostream* out) {
  *out << benchmark.name;
}

class G2oTest : public testing::TestWithParam<Benchmark> {};

TEST_P(G2oTest, OptimumAgreesWithSeSyncAndWithMatrixLogarithms) {
  const std::string path = std::string(SGRAPHS_SHARED_DATA_DIR) + "/g2o/" + GetParam().name + ".g2o";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  const G2oFile file = readG2o(path);
  SolverOptions options;
  options.max_iterations = 50;
  IncrementalSolver solver(options);
  std::map<int, IncrementalSolver::StateId> states;
  for (const auto& [id, T] : file.vertices) states[id] = solver.addPose(T);
  solver.hold(states.begin()->second);
  for (const Edge& edge : file.edges)
    solver.addFactor(RelativePoseCost::Create(edge.T_from_to, isotropicCovariance(edge.information)),
                     {states.at(edge.from), states.at(edge.to)});
  const auto start = std::chrono::steady_clock::now();
  const IncrementalSolver::Report report = solver.solve(true);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  EXPECT_TRUE(report.converged);

  double chi2 = 0, independent = 0;
  for (size_t i = 0; i < file.edges.size(); ++i) {
    const Edge& edge = file.edges[i];
    chi2 += solver.chi2(static_cast<int>(i));
    independent += independentChi2(edge, solver.pose(states.at(edge.from)), solver.pose(states.at(edge.to)));
  }
  RecordProperty("chi2", std::to_string(chi2));
  std::cout << GetParam().name << ": chi2 " << chi2 << ", " << report.iterations << " iterations, "
            << elapsed.count() << " s\n";
  EXPECT_NEAR(chi2, independent, 1e-6 * independent);
  EXPECT_NEAR(chi2, GetParam().se_sync_optimum, GetParam().tolerance * GetParam().se_sync_optimum);
}

INSTANTIATE_TEST_SUITE_P(PublicGraphs, G2oTest,
                         testing::Values(Benchmark{"smallGrid3D", 1025.4, 0.05},
                                         Benchmark{"parking-garage", 1.263, 0.05},
                                         Benchmark{"sphere2500", 1687.0, 0.05}),
                         [](const auto& param_info) {
                           std::string name = param_info.param.name;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace sgraphs
