#include <Eigen/LU>
#include <cstdio>

#include "backend/output/graph_files.h"

namespace sgraphs {
namespace {

void append(std::string& text, double value) {
  char number[32];
  std::snprintf(number, sizeof number, " %.17g", value);
  text += number;
}

void append(std::string& text, const SE3& T) {
  for (int i = 0; i < 3; ++i) append(text, T.translation[i]);
  for (const double c : {T.rotation.x(), T.rotation.y(), T.rotation.z(), T.rotation.w()}) append(text, c);
}

Matrix6d g2oInformation(const Matrix6d& covariance) {
  Matrix6d information = covariance.inverse();
  information = 0.5 * (information + information.transpose().eval());
  information.rightCols<3>() *= 2;
  information.bottomRows<3>() *= 2;
  return information;
}

}  // namespace

std::string graphG2o(const SituationalGraph& graph) {
  std::string text =
      "# body poses in map; EDGE information is in g2o's tangent (translation, quaternion vector part)\n";
  if (!graph.ups.empty())
    text += "# gravity (up) factors have no counterpart in stock g2o and are left out\n";
  for (const auto& [id, node] : graph.keyframes) {
    text += "VERTEX_SE3:QUAT " + std::to_string(id.value);
    append(text, node.T_map_body);
    text += "\n";
  }
  if (!graph.keyframes.empty()) text += "FIX " + std::to_string(graph.keyframes.begin()->first.value) + "\n";
  for (const auto& factor : graph.relative_poses) {
    const RelativePose& m = factor.measurement;
    text += "EDGE_SE3:QUAT " + std::to_string(m.from.value) + " " + std::to_string(m.to.value);
    append(text, m.T_from_to);
    const Matrix6d information = g2oInformation(m.covariance);
    for (int row = 0; row < 6; ++row)
      for (int col = row; col < 6; ++col) append(text, information(row, col));
    text += "\n";
  }
  return text;
}

}  // namespace sgraphs
