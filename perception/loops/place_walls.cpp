#include "perception/loops/place_walls.h"

#include <algorithm>
#include <cmath>

namespace sgraphs {
namespace {

constexpr size_t kMaxWalls = 300;
constexpr float kWallNormal = 0.3F;  // |n_z| below

}  // namespace

std::vector<WallPoint> wallsOf(const std::vector<PlacedPlace>& places) {
  std::vector<WallPoint> out;
  for (const PlacedPlace& p : places) {
    const Eigen::Matrix3f R = p.T_frame_body.matrix3().cast<float>();
    const Eigen::Vector3f t = p.T_frame_body.translation.cast<float>();
    for (const PackedPatch& patch : p.place->patches) {
      const Eigen::Vector3f n = R * patch.normal();
      if (std::abs(n.z()) > kWallNormal) continue;
      out.push_back({(R * patch.mean() + t).head<2>(), std::atan2(n.y(), n.x())});
    }
  }
  return out;
}

std::vector<WallPoint> wallsAround(std::vector<PlacedPlace> query, const Eigen::Quaterniond& R_level_body) {
  for (PlacedPlace& p : query) p.T_frame_body = SE3(R_level_body, {0, 0, 0}) * p.T_frame_body;
  std::vector<WallPoint> near, out;
  for (const WallPoint& w : wallsOf(query))
    if (w.position.norm() < kQueryReach_m) near.push_back(w);
  const size_t n = std::min(near.size(), kMaxWalls);
  for (size_t i = 0; i < n; ++i) out.push_back(near[i * near.size() / n]);
  return out;
}

}  // namespace sgraphs
