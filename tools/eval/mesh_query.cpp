#include "tools/eval/mesh_query.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <stdexcept>

namespace sgraphs {
namespace {

// Nearest point of a triangle: the projection onto its plane if that lies inside, else onto the nearest edge.
double distanceToTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                          const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const auto inside = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return normal.dot((to - from).cross(p - from)) >= 0;
  };
  const double doubled_area = normal.norm();
  if (doubled_area > 1e-12 && inside(a, b) && inside(b, c) && inside(c, a))
    return std::abs(normal.dot(p - a)) / doubled_area;
  const auto to_edge = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d edge = to - from;
    const double squared = edge.squaredNorm();
    const double s = squared > 0 ? std::clamp(edge.dot(p - from) / squared, 0.0, 1.0) : 0.0;
    return (p - from - s * edge).norm();
  };
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

}  // namespace

class MeshQuery::Impl {
 public:
  explicit Impl(const TriangleMesh& mesh) : mesh_(mesh) {
    // Embree computes in float: far-off coordinates are brought near zero first.
    for (const auto& v : mesh.vertices) center_ += v / static_cast<double>(mesh.vertices.size());
    device_ = rtcNewDevice("threads=1");
    if (!device_) throw std::runtime_error("Embree cannot start");
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles.size()));
    for (const auto& v : mesh.vertices)
      for (int k = 0; k < 3; ++k) *vertices++ = static_cast<float>(v[k] - center_[k]);
    for (const auto& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) *indices++ = static_cast<unsigned>(t[k]);
    rtcSetGeometryPointQueryFunction(geometry, &Impl::visit);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }

  ~Impl() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  std::optional<double> distance(const Eigen::Vector3d& point, double max_distance) const {
    const Eigen::Vector3f p = (point - center_).cast<float>();
    RTCPointQuery query{p.x(), p.y(), p.z(), 0, static_cast<float>(max_distance)};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    Search search{this, point, max_distance, false};
    rtcPointQuery(scene_, &query, &context, nullptr, &search);
    if (!search.found) return std::nullopt;
    return search.best;
  }

  bool occluded(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double margin) const {
    const Eigen::Vector3d direction = to - from;
    const double length = direction.norm();
    if (length <= margin) return false;
    const Eigen::Vector3f origin = (from - center_).cast<float>();
    const Eigen::Vector3f unit = (direction / length).cast<float>();
    RTCRay ray{};
    ray.org_x = origin.x(), ray.org_y = origin.y(), ray.org_z = origin.z();
    ray.dir_x = unit.x(), ray.dir_y = unit.y(), ray.dir_z = unit.z();
    ray.tnear = 0;
    ray.tfar = static_cast<float>(length - margin);
    ray.mask = std::numeric_limits<unsigned>::max();
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_, &context, &ray);
    return ray.tfar < 0;  // Embree's sign for a hit
  }

 private:
  struct Search {
    const Impl* impl;
    Eigen::Vector3d point;
    double best;
    bool found;
  };

  // Called for each triangle whose box the query's sphere touches.
  static bool visit(RTCPointQueryFunctionArguments* arguments) {
    auto& search = *static_cast<Search*>(arguments->userPtr);
    const TriangleMesh& mesh = search.impl->mesh_;
    const Eigen::Vector3i& t = mesh.triangles[arguments->primID];
    const double d =
        distanceToTriangle(search.point, mesh.vertices[t.x()], mesh.vertices[t.y()], mesh.vertices[t.z()]);
    if (d > search.best) return false;
    search.best = d;
    search.found = true;
    arguments->query->radius = static_cast<float>(d);
    return true;
  }

  TriangleMesh mesh_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

MeshQuery::MeshQuery(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>(mesh)) {}
MeshQuery::~MeshQuery() = default;

std::optional<double> MeshQuery::distance(const Eigen::Vector3d& point, double max_distance_m) const {
  return impl_->distance(point, max_distance_m);
}

bool MeshQuery::occluded(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double margin_m) const {
  return impl_->occluded(from, to, margin_m);
}

}  // namespace sgraphs
