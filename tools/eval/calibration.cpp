#include "tools/eval/calibration.h"

#include <Eigen/Cholesky>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/error.h"
#include "common/io/text_file.h"
#include "tools/eval/graph_sessions.h"
#include "tools/eval/trajectory_error.h"

namespace sgraphs {
namespace {

constexpr double kChi2Of95Percent = 7.814727903;  // three degrees of freedom

SE3 transformOf(const nlohmann::json& json) {
  const auto t = json.at("xyz").get<std::array<double, 3>>();
  const auto q = json.at("qxyzw").get<std::array<double, 4>>();
  return {Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized(), {t[0], t[1], t[2]}};
}

Matrix6d covarianceOf(const nlohmann::json& json) {
  const auto entries = json.get<std::array<double, 21>>();
  Matrix6d covariance;
  size_t next = 0;
  for (int row = 0; row < 6; ++row)
    for (int col = row; col < 6; ++col) covariance(row, col) = covariance(col, row) = entries[next++];
  return covariance;
}

double nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  return error.dot(covariance.ldlt().solve(error));
}

}  // namespace

std::vector<MeasuredLink> readMeasuredLinks(const std::string& graph_json_path) {
  try {
    const auto json = nlohmann::json::parse(readFile(graph_json_path));
    std::map<std::string, Time> times;
    const int session = lastSession(json);
    std::set<std::string> earlier;
    for (const auto& node : json.at("nodes"))
      if (node.at("layer") == "keyframes") {
        if (sessionOf(node) != session) earlier.insert(node.at("id").get<std::string>());
        times[node.at("id")] = {node.at("utime").get<int64_t>()};
      }
    std::vector<MeasuredLink> links;
    for (const auto& link : json.at("links")) {
      if (!link.contains("covariance") || !link.contains("T_source_target")) continue;
      if (earlier.contains(link.at("source")) || earlier.contains(link.at("target"))) continue;
      links.push_back({link.at("kind"), times.at(link.at("source")), times.at(link.at("target")),
                       transformOf(link.at("T_source_target")), covarianceOf(link.at("covariance"))});
    }
    return links;
  } catch (const nlohmann::json::exception& error) {
    throw Error("cannot read graph '" + graph_json_path + "': " + error.what());
  } catch (const std::out_of_range&) {
    throw Error("cannot read graph '" + graph_json_path + "': a link names a keyframe that does not exist");
  }
}

std::map<std::string, Calibration> calibrationOf(const std::vector<MeasuredLink>& links,
                                                 const std::vector<StampedPose>& truth) {
  std::map<std::string, Calibration> result;
  for (const MeasuredLink& link : links) {
    const auto T_truth_from = poseAt(truth, link.from), T_truth_to = poseAt(truth, link.to);
    if (!T_truth_from || !T_truth_to) continue;
    const Vector6d error = se3Log(link.T_from_to.inverse() * T_truth_from->inverse() * *T_truth_to);
    const double translation = nees(error.head<3>(), link.covariance.topLeftCorner<3, 3>());
    const double rotation = nees(error.tail<3>(), link.covariance.bottomRightCorner<3, 3>());
    Calibration& c = result[link.kind];
    ++c.count;
    c.nees_translation += translation;
    c.nees_rotation += rotation;
    c.inside_translation += translation <= kChi2Of95Percent;
    c.inside_rotation += rotation <= kChi2Of95Percent;
  }
  for (auto& [kind, c] : result)
    for (double* mean : {&c.nees_translation, &c.nees_rotation, &c.inside_translation, &c.inside_rotation})
      *mean /= static_cast<double>(c.count);
  return result;
}

}  // namespace sgraphs
