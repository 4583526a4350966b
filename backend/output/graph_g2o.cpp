#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <cstdio>

#include "backend/output/graph_files.h"
#include "common/geometry/tangent_basis.h"

namespace sgraphs {
namespace {

void append(std::string& text, double value) {
  char number[32];
  std::snprintf(number, sizeof number, " %.17g", value);
  text += number;
}

template <typename Derived>
void append(std::string& text, const Eigen::MatrixBase<Derived>& vector) {
  for (Eigen::Index i = 0; i < vector.size(); ++i) append(text, vector(i));
}

void append(std::string& text, const SE3& T) {
  append(text, T.translation);
  append(text, T.rotation.coeffs());  // x, y, z, w
}

template <typename Derived>
void appendUpperTriangle(std::string& text, const Eigen::MatrixBase<Derived>& matrix) {
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (Eigen::Index col = row; col < matrix.cols(); ++col) append(text, matrix(row, col));
}

// g2o's error of EDGE_SE3:QUAT is (translation, vector part of the unit quaternion) of Z^-1 Xi^-1 Xj: its
// rotation coordinates are half our angles, so each rotation row and column of the information is doubled.
Matrix6d g2oInformation(const Matrix6d& covariance) {
  Matrix6d information = covariance.inverse();
  information = 0.5 * (information + information.transpose().eval());
  information.rightCols<3>() *= 2;
  information.bottomRows<3>() *= 2;
  return information;
}

// g2o's axes perpendicular to a normal: azimuth grows along the first, elevation along the second.
TangentBasis azimuthElevationBasis(const Eigen::Vector3d& n) {
  const double azimuth = std::atan2(n.y(), n.x());
  const double elevation = std::atan2(n.z(), n.head<2>().norm());
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(azimuth, Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(-elevation, Eigen::Vector3d::UnitY()))
                                .toRotationMatrix();
  return R.rightCols<2>();
}

// A plane seen in a frame, as EDGE_SE3_PLANE_CALIB holds it.
struct G2oPlane {
  Eigen::Vector4d coefficients;  // (n, d) with n.p + d = 0, as ours
  Eigen::Matrix3d information;
};

// g2o's error is (azimuth, elevation) of the measured normal in the axes a, b of the plane predicted from the
// states, and the predicted distance (-d) less the measured one. With the true plane at (tilt_u, tilt_v,
// offset) from the measurement, the measured normal lies at -(tilt_u u + tilt_v v) from the true one, and the
// true -d is the measured plus offset + (tilt_u u + tilt_v v).c. So, to first order, the error is
//   J (tilt_u, tilt_v, offset),   J = [ -a.u  -a.v  0 ;  -b.u  -b.v  0 ;  c.u  c.v  1 ].
G2oPlane g2oPlane(const PlaneObservation& plane, const Eigen::Matrix3d& R_body_sensor) {
  const Eigen::Vector3d n = R_body_sensor.transpose() * plane.normal_body;
  const Eigen::Vector3d c = R_body_sensor.transpose() * plane.centroid_body;
  const TangentBasis uv = R_body_sensor.transpose() * tangentBasis(plane.normal_body);
  Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
  J.topLeftCorner<2, 2>() = -azimuthElevationBasis(n).transpose() * uv;
  J.bottomLeftCorner<1, 2>() = c.transpose() * uv;
  J(2, 2) = 1;
  const Eigen::Matrix3d information = (J * plane.covariance * J.transpose()).inverse();
  return {{n.x(), n.y(), n.z(), plane.d()}, 0.5 * (information + information.transpose())};
}

// Azimuth means nothing near the poles, so a plane that is nearer to level than to plumb is told in a frame
// that lies on its side (sensor z along body x): a sensor offset of the calibration edge.
bool isSteep(const Eigen::Vector3d& normal) {
  return std::abs(normal.z()) > M_SQRT1_2;
}
const Eigen::Quaterniond& onItsSide() {
  static const Eigen::Quaterniond q(M_SQRT1_2, 0, M_SQRT1_2, 0);
  return q;
}

// Ids: keyframes as they are, planes behind the last keyframe, then the two sensor offsets.
struct G2oIds {
  int64_t first_plane = 0;
  int64_t upright = 0;
  int64_t on_its_side = 0;

  explicit G2oIds(const SituationalGraph& graph) {
    first_plane = graph.keyframes.empty() ? 0 : graph.keyframes.rbegin()->first.value + 1;
    upright = first_plane + (graph.planes.empty() ? 0 : graph.planes.rbegin()->first.value + 1);
    on_its_side = upright + 1;
  }
  int64_t plane(PlaneId id) const { return first_plane + id.value; }
};

constexpr const char* kPlaneColor = " 0.2 0.2 0.2";

void appendVertices(std::string& text, const SituationalGraph& graph, const G2oIds& ids) {
  const auto vertex = [&text](int64_t id, const SE3& T) {
    text += "VERTEX_SE3:QUAT " + std::to_string(id);
    append(text, T);
    text += "\n";
  };
  for (const auto& [id, node] : graph.keyframes) vertex(id.value, node.T_map_body);
  for (const auto& [id, plane] : graph.planes) {
    text += "VERTEX_PLANE " + std::to_string(ids.plane(id));
    append(text, plane.normal_map);
    append(text, plane.d());
    text += std::string(kPlaneColor) + "\n";
  }
  if (!graph.observations.empty()) {
    vertex(ids.upright, SE3{});
    vertex(ids.on_its_side, SE3(onItsSide(), Eigen::Vector3d::Zero()));
    text += "FIX " + std::to_string(ids.upright) + " " + std::to_string(ids.on_its_side) + "\n";
  }
  if (!graph.keyframes.empty()) text += "FIX " + std::to_string(graph.keyframes.begin()->first.value) + "\n";
}

void appendEdges(std::string& text, const SituationalGraph& graph, const G2oIds& ids) {
  for (const auto& factor : graph.relative_poses) {
    const RelativePose& m = factor.measurement;
    text += "EDGE_SE3:QUAT " + std::to_string(m.from.value) + " " + std::to_string(m.to.value);
    append(text, m.T_from_to);
    appendUpperTriangle(text, g2oInformation(m.covariance));
    text += "\n";
  }
  for (const auto& factor : graph.observations) {
    const bool steep = isSteep(factor.measurement.normal_body);
    const G2oPlane plane =
        g2oPlane(factor.measurement, steep ? onItsSide().toRotationMatrix() : Eigen::Matrix3d::Identity());
    text += "EDGE_SE3_PLANE_CALIB " + std::to_string(factor.keyframe.value) + " " +
            std::to_string(ids.plane(factor.plane)) + " " +
            std::to_string(steep ? ids.on_its_side : ids.upright);
    append(text, plane.coefficients);
    text += kPlaneColor;
    appendUpperTriangle(text, plane.information);
    text += "\n";
  }
}

}  // namespace

std::string graphG2o(const SituationalGraph& graph) {
  const G2oIds ids(graph);
  std::string text =
      "# body poses in map; information of EDGE_SE3:QUAT is in g2o's tangent (translation, quaternion vector "
      "part),\n# that of EDGE_SE3_PLANE_CALIB in (azimuth, elevation, distance) of the plane in the sensor\n";
  text += "# keyframe k is vertex k, plane w is vertex " + std::to_string(ids.first_plane) + " + w\n";
  if (!graph.ups.empty())
    text += "# gravity (up) factors have no counterpart in stock g2o and are left out\n";
  if (!graph.plane_ups.empty() || !graph.faces.empty() || !graph.same_heights.empty())
    text += "# so are level and plumb planes, faces of one wall and planes at one height\n";
  appendVertices(text, graph, ids);
  appendEdges(text, graph, ids);
  return text;
}

}  // namespace sgraphs
