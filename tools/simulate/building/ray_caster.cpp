#include "tools/simulate/building/ray_caster.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "common/base/error.h"

namespace sgraphs::simulate {
namespace {

double squaredDistanceToSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                const Eigen::Vector3d& b) {
  const double s = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - s * (b - a)).squaredNorm();
}

double squaredDistance(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                       const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
  const bool above = (b - a).cross(p - a).dot(normal) >= 0 && (c - b).cross(p - b).dot(normal) >= 0 &&
                     (a - c).cross(p - c).dot(normal) >= 0;
  if (above) return std::pow(normal.dot(p - a), 2);
  return std::min({squaredDistanceToSegment(p, a, b), squaredDistanceToSegment(p, b, c),
                   squaredDistanceToSegment(p, c, a)});
}

double squaredDistance(const Eigen::Vector3d& p, const TriangleMesh& mesh) {
  double best = std::numeric_limits<double>::max();
  for (const auto& t : mesh.triangles)
    best = std::min(best, squaredDistance(p, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
  return best;
}

}  // namespace

// Has a name, as RayCaster::Impl has one, which is made of it.
namespace embree {

// A mesh as Embree searches it.
class SearchTree {
 public:
  SearchTree() = default;
  SearchTree(const SearchTree&) = delete;
  SearchTree& operator=(const SearchTree&) = delete;
  ~SearchTree() {
    if (scene_) rtcReleaseScene(scene_);
  }

  bool empty() const { return !scene_; }

  void build(RTCDevice device, const TriangleMesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    for (const auto& v : mesh.vertices)
      for (int i = 0; i < 3; ++i) *vertices++ = static_cast<float>(v[i]);
    auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), mesh.triangles.size()));
    for (const auto& t : mesh.triangles) indices = std::copy(t.begin(), t.end(), indices);
    rtcCommitGeometry(geometry);
    scene_ = rtcNewScene(device);
    // Robust: no ray slips through the edge that two triangles share.
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }

  std::optional<RayHit> first(const TriangleMesh& mesh, const Eigen::Vector3d& origin,
                              const Eigen::Vector3d& direction, double min_range_m,
                              double max_range_m) const {
    RTCRayHit query{};
    query.ray.org_x = static_cast<float>(origin.x());
    query.ray.org_y = static_cast<float>(origin.y());
    query.ray.org_z = static_cast<float>(origin.z());
    query.ray.dir_x = static_cast<float>(direction.x());
    query.ray.dir_y = static_cast<float>(direction.y());
    query.ray.dir_z = static_cast<float>(direction.z());
    query.ray.tnear = static_cast<float>(min_range_m);
    query.ray.tfar = static_cast<float>(max_range_m);
    query.ray.mask = ~0U;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const Eigen::Vector3d normal =
        Eigen::Vector3d(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized();
    return RayHit{query.ray.tfar, std::min(1.0, std::abs(normal.dot(direction))),
                  mesh.reflectivity[query.hit.primID]};
  }

 private:
  RTCScene scene_ = nullptr;
};

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};

}  // namespace embree

struct RayCaster::Impl {
  TriangleMesh mesh, glass;
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, embree::DeviceRelease> device;
  embree::SearchTree mesh_tree, glass_tree;  // after the device: they go before it
};

RayCaster::RayCaster(const TriangleMesh& mesh, const TriangleMesh& glass) : impl_(std::make_unique<Impl>()) {
  if (mesh.triangles.empty()) throw Error("the building has no surface to measure: give it walls");
  // One thread and one instruction set build the same tree and intersect with the same rounding everywhere.
  impl_->device.reset(rtcNewDevice("threads=1,isa=sse4.2"));
  if (!impl_->device) throw Error("the ray caster does not start: it needs a processor with SSE 4.2");
  impl_->mesh = mesh;
  impl_->mesh_tree.build(impl_->device.get(), mesh);
  if (glass.triangles.empty()) return;
  impl_->glass = glass;
  impl_->glass_tree.build(impl_->device.get(), glass);
}

RayCaster::~RayCaster() = default;

std::optional<RayHit> RayCaster::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                      double max_range_m) const {
  return impl_->mesh_tree.first(impl_->mesh, origin, direction, 0, max_range_m);
}

bool RayCaster::hasGlass() const {
  return !impl_->glass_tree.empty();
}

std::optional<RayHit> RayCaster::castGlass(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                           double min_range_m, double max_range_m) const {
  if (!hasGlass()) return std::nullopt;
  return impl_->glass_tree.first(impl_->glass, origin, direction, min_range_m, max_range_m);
}

double RayCaster::distanceToSurface(const Eigen::Vector3d& point) const {
  return std::sqrt(std::min(squaredDistance(point, impl_->mesh), squaredDistance(point, impl_->glass)));
}

}  // namespace sgraphs::simulate
