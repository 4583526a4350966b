// Public pose graphs as a check of the whole-graph solve against answers that share no code with it: the
// optimum that Ceres finds by its own quaternion manifold and automatic derivatives, and an evaluation of the
// residuals by matrix logarithms.
#include <ceres/autodiff_cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
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

// Translation and rotation of an edge are weighed by one number each, the mean of the variances: a problem
// that does not depend on how a file scales and couples its rotation part.
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

// Log(Z^-1 Xi^-1 Xj) in standard deviations, for automatic differentiation.
struct EdgeResidual {
  Edge edge;
  Vector6d sigma;

  template <typename T>
  bool operator()(const T* ti, const T* qi, const T* tj, const T* qj, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const Eigen::Quaternion<T>> Qi(qi), Qj(qj);
    const Eigen::Map<const Vector> Ti(ti), Tj(tj);
    const Eigen::Quaternion<T> Qz = edge.T_from_to.rotation.cast<T>().conjugate();
    const Eigen::Quaternion<T> q = Qz * Qi.conjugate() * Qj;
    const Vector t = Qz * (Qi.conjugate() * (Tj - Ti) - edge.T_from_to.translation.cast<T>());
    const T sine = sqrt(q.vec().squaredNorm() + T(1e-30));
    const T angle = T(2.0) * atan2(q.w() < T(0.0) ? -sine : sine, q.w() < T(0.0) ? -q.w() : q.w());
    const Vector w = angle / sine * q.vec();
    // Inverse of the left Jacobian: 1 - w/2 x + (1 - (angle / 2) cot(angle / 2)) / angle^2 w x w x.
    const T half = T(0.5) * angle;
    const T c =
        angle * angle < T(1e-8) ? T(1.0 / 12.0) : (T(1.0) - half * cos(half) / sin(half)) / (angle * angle);
    const Vector rho = t - T(0.5) * w.cross(t) + c * w.cross(w.cross(t));
    for (int i = 0; i < 3; ++i) {
      residual[i] = rho[i] / sigma[i];
      residual[3 + i] = w[i] / sigma[3 + i];
    }
    return true;
  }
};

double optimumByCeres(const G2oFile& file) {
  std::map<int, SE3> poses = file.vertices;
  ceres::Problem problem;
  for (auto& [id, T] : poses) {
    problem.AddParameterBlock(T.translation.data(), 3);
    problem.AddParameterBlock(T.rotation.coeffs().data(), 4, new ceres::EigenQuaternionManifold);
  }
  problem.SetParameterBlockConstant(poses.begin()->second.translation.data());
  problem.SetParameterBlockConstant(poses.begin()->second.rotation.coeffs().data());
  for (const Edge& edge : file.edges) {
    const Vector6d sigma = isotropicCovariance(edge.information).diagonal().cwiseSqrt();
    SE3 &a = poses.at(edge.from), &b = poses.at(edge.to);
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<EdgeResidual, 6, 3, 4, 3, 4>(new EdgeResidual{edge, sigma}), nullptr,
        a.translation.data(), a.rotation.coeffs().data(), b.translation.data(), b.rotation.coeffs().data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return 2.0 * summary.final_cost;
}

class G2oTest : public testing::TestWithParam<const char*> {};

TEST_P(G2oTest, OptimumAgreesWithCeresAndWithMatrixLogarithms) {
  const std::string path = std::string(SGRAPHS_SHARED_DATA_DIR) + "/g2o/" + GetParam() + ".g2o";
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
  std::cout << GetParam() << ": chi2 " << chi2 << ", " << report.iterations << " iterations, "
            << elapsed.count() << " s\n";
  EXPECT_NEAR(chi2, independent, 1e-6 * independent);
  const double reference = optimumByCeres(file);
  EXPECT_NEAR(chi2, reference, 1e-5 * reference);
}

INSTANTIATE_TEST_SUITE_P(PublicGraphs, G2oTest,
                         testing::Values("smallGrid3D", "parking-garage", "sphere2500"),
                         [](const auto& param_info) {
                           std::string name = param_info.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace sgraphs
