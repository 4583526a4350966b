#include "perception/planes/plane_segmentation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "common/geometry/tangent_basis.h"
#include "perception/planes/facets.h"
#include "perception/planes/plane_fit.h"
#include "perception/planes/plane_grid.h"
#include "perception/planes/plane_outline.h"
#include "perception/planes/plane_search.h"

namespace sgraphs {
namespace {

constexpr int kMaxCorners = 48;  // of a boundary, as messages hold them
// A surface that is hardly facing the viewpoint has not been seen from there.
constexpr double kMinFacing = 0.02;
// A segment is no plane of its own if more than this share of it lies on planes found before: where a wall
// meets the floor, normals between the two make a bevel that is not there.
constexpr double kMaxExplained = 0.5;
// Half width of a plane in standard deviations of the cloud's noise, and its limit.
constexpr double kGateSigmas = 4;
constexpr double kMaxGate_m = 0.15;
// Normals this far from vertical have a horizontal axis worth drawing along.
constexpr double kMaxUpright = 0.95;

constexpr int kBehind = 3;

// Axes of the grids in a plane: along the floor and upwards where there is such a direction, so that the
// outline of a wall is a rectangle. Right-handed with the normal.
TangentBasis gridAxes(const Eigen::Vector3d& normal) {
  if (std::abs(normal.z()) > kMaxUpright) return tangentBasis(normal);
  TangentBasis axes;
  axes.col(0) = Eigen::Vector3d::UnitZ().cross(normal).normalized();
  axes.col(1) = normal.cross(axes.col(0));
  return axes;
}

// A noisier LiDAR needs a wider gate, or the tails of its noise become planes beside the plane.
PlaneSearchConfig widened(PlaneSearchConfig config, double thickness_m) {
  config.distance_m = std::max(config.distance_m, std::min(kGateSigmas * thickness_m, kMaxGate_m));
  return config;
}

// Whether a segment is made of the outliers of a plane found before: just beyond its gate, within its
// outline, facing the same way, and with a tenth of its points per area. A board before a wall has as many as
// the wall. What lies just behind the plane, where nothing can be seen but through its openings, needs to
// have a third of its points: jambs, panes and far points at grazing incidence make ghosts of the wall there.
bool isTailOf(const PlaneObservation& plane, const PlaneObservation& found, double gate_m, double min_cos) {
  const Eigen::Vector3d delta = plane.centroid_body - found.centroid_body;
  const double before_m = found.normal_body.dot(delta), distance_m = std::abs(before_m);
  if (distance_m < 0.5 * gate_m || distance_m > 3 * gate_m) return false;
  if (plane.normal_body.dot(found.normal_body) < min_cos) return false;
  const bool behind = before_m < 0 && kBehind * plane.num_points < found.num_points;
  if (!behind && 10 * plane.num_points * found.area_m2 > found.num_points * plane.area_m2) return false;
  const Eigen::Vector2f at = (tangentBasis(found.normal_body).transpose() * delta).cast<float>();
  Eigen::AlignedBox2f bounds;
  for (const Eigen::Vector2f& corner : found.boundary) bounds.extend(corner);
  return bounds.contains(at);
}

// Points of one connected segment, by index.
struct Segment {
  std::vector<int32_t> core;    // with a normal of their own: they decide the plane
  std::vector<int32_t> fringe;  // on its edges: they only widen the outline
};

class Run {
 public:
  Run(const Keyframe& keyframe, const PlanesConfig& config)
      : config_(config),
        cloud_(makeFacets(keyframe, config.facets)),
        search_config_(widened(config.search, cloud_.thickness_m)),
        search_(cloud_.facets, search_config_, config.segments.min_area_m2,
                static_cast<uint64_t>(keyframe.id.value)),
        min_cos_(std::cos(config.search.normal_angle_rad)) {
    for (size_t i = 0; i < cloud_.points.size(); ++i) free_.push_back(static_cast<int32_t>(i));
  }

  std::vector<PlaneObservation> planes() {
    std::vector<PlaneObservation> found;
    while (const std::optional<Hypothesis> plane = search_.next()) {
      for (const Segment& segment : segmentsOf(*plane)) {
        std::optional<PlaneObservation> observation = observe(segment, *plane);
        const bool tail = observation && std::any_of(found.begin(), found.end(), [&](const auto& other) {
                            return isTailOf(*observation, other, search_config_.distance_m, min_cos_);
                          });
        if (observation && !tail) {
          take(segment, *observation);
          found.push_back(std::move(*observation));
        } else {
          for (const int32_t i : segment.core) search_.passOver(point(i).facet);
        }
      }
    }
    std::stable_sort(found.begin(), found.end(), [](const PlaneObservation& a, const PlaneObservation& b) {
      return a.area_m2 > b.area_m2;
    });
    if (found.size() > static_cast<size_t>(config_.segments.max_planes))
      found.resize(static_cast<size_t>(config_.segments.max_planes));
    return found;
  }

 private:
  const ViewedPoint& point(int32_t i) const { return cloud_.points[static_cast<size_t>(i)]; }

  bool agrees(const ViewedPoint& p, const Hypothesis& plane) const {
    return p.facet >= 0 && cloud_.facets[static_cast<size_t>(p.facet)].normal.dot(plane.normal) >= min_cos_;
  }

  // All that may belong to the plane, seen from its front.
  Segment membersOf(const Hypothesis& plane) const {
    Segment members;
    for (const int32_t i : free_) {
      const ViewedPoint& p = point(i);
      if (std::abs(plane.distance(p.position)) > search_config_.distance_m) continue;
      if (plane.normal.dot(p.to_viewpoint) < kMinFacing) continue;
      if (p.facet < 0)
        members.fringe.push_back(i);
      else if (agrees(p, plane))
        members.core.push_back(i);
    }
    return members;
  }

  std::vector<Eigen::Vector2d> project(const std::vector<int32_t>& members, const TangentBasis& axes) const {
    std::vector<Eigen::Vector2d> places;
    places.reserve(members.size());
    for (const int32_t i : members) places.emplace_back(axes.transpose() * point(i).position);
    return places;
  }

  // Core points whose grid cells are closer than `link_m` are connected; fringe points join the segment whose
  // cells, widened by one, they lie on.
  std::vector<Segment> segmentsOf(const Hypothesis& plane) const {
    const Segment members = membersOf(plane);
    if (members.core.empty()) return {};
    const PlaneSegmentConfig& config = config_.segments;
    const TangentBasis axes = gridAxes(plane.normal);
    const std::vector<Eigen::Vector2d> core = project(members.core, axes),
                                       fringe = project(members.fringe, axes);
    const int radius = linkRadius();
    PlaneGrid linked(core, config.grid_m, radius + 1);
    PlaneGrid near = linked;
    linked.dilate(radius);
    near.dilate(1);
    int num_segments = 0;
    const std::vector<int32_t> region_of = linked.regions(&num_segments);
    std::vector<Segment> segments(static_cast<size_t>(num_segments));
    for (size_t i = 0; i < core.size(); ++i)
      segments[static_cast<size_t>(region_of[linked.cellOf(core[i])])].core.push_back(members.core[i]);
    for (size_t i = 0; i < fringe.size(); ++i)
      if (near.isFilled(fringe[i]))
        segments[static_cast<size_t>(region_of[linked.cellOf(fringe[i])])].fringe.push_back(
            members.fringe[i]);
    return segments;
  }

  std::optional<PlaneObservation> observe(const Segment& segment, const Hypothesis& start) const {
    const PlaneSegmentConfig& config = config_.segments;
    int raw_points = 0;
    size_t explained = 0;
    for (const int32_t i : segment.core) {
      raw_points += point(i).count;
      explained += point(i).explained;
    }
    if (raw_points < config.min_points) return std::nullopt;
    if (static_cast<double>(explained) > kMaxExplained * static_cast<double>(segment.core.size()))
      return std::nullopt;
    const PlaneFit fit =
        fitPlane(cloud_.points, segment.core, start, search_config_.distance_m, config_.noise);
    if (!fit.valid || fit.rms_m > config.max_rms_m) return std::nullopt;
    std::vector<int32_t> all = segment.core;
    all.insert(all.end(), segment.fringe.begin(), segment.fringe.end());
    const TangentBasis axes = gridAxes(fit.plane.normal);
    const Outline outline = outlineOf(project(all, axes), config.grid_m, config.link_m, kMaxCorners);
    PlaneObservation plane;
    plane.area_m2 = polygonArea(outline.polygon);
    if (plane.area_m2 < config.min_area_m2 || outline.filled < config.min_filled) return std::nullopt;
    plane.normal_body = fit.plane.normal;
    plane.centroid_body = fit.centroid;
    plane.covariance = fit.covariance;
    plane.num_points = raw_points;
    plane.rms_m = fit.rms_m;
    const TangentBasis uv = tangentBasis(fit.plane.normal);
    for (const Eigen::Vector2d& corner : outline.polygon)
      plane.boundary.emplace_back((uv.transpose() * (axes * corner - fit.centroid)).cast<float>());
    return plane;
  }

  void take(const Segment& segment, const PlaneObservation& plane) {
    explain(segment, {plane.normal_body, plane.d()});
    for (const std::vector<int32_t>* members : {&segment.core, &segment.fringe})
      for (const int32_t i : *members) {
        cloud_.points[static_cast<size_t>(i)].count = 0;
        if (point(i).facet >= 0) search_.take(point(i).facet);
      }
    std::erase_if(free_, [this](int32_t i) { return point(i).count == 0; });
  }

  // Marks the points on the plane, seen from its front, in and around the segment; where the normal is
  // another, twice as far from it.
  void explain(const Segment& segment, const Hypothesis& plane) {
    const TangentBasis axes = gridAxes(plane.normal);
    const int radius = linkRadius();
    PlaneGrid grid(project(segment.core, axes), config_.segments.grid_m, radius + 1);
    grid.dilate(radius);
    for (const int32_t i : free_) {
      ViewedPoint& p = cloud_.points[static_cast<size_t>(i)];
      const double distance_m = std::abs(plane.distance(p.position));
      if (distance_m > 2 * search_config_.distance_m || plane.normal.dot(p.to_viewpoint) < kMinFacing)
        continue;
      if (distance_m > search_config_.distance_m && agrees(p, plane)) continue;
      if (grid.isFilled(axes.transpose() * p.position)) p.explained = true;
    }
  }

  // Dilating by this links cells up to link_m apart.
  int linkRadius() const {
    return std::max(1,
                    static_cast<int>(std::lround(0.5 * config_.segments.link_m / config_.segments.grid_m)));
  }

  const PlanesConfig& config_;
  FacetCloud cloud_;
  PlaneSearchConfig search_config_;
  PlaneSearch search_;
  double min_cos_;
  std::vector<int32_t> free_;  // points of no plane yet
};

}  // namespace

KeyframePlanes PlaneSegmentation::step(const Keyframe& keyframe) const {
  KeyframePlanes result;
  result.keyframe = keyframe.id;
  result.pose_sigma = config_.noise.poseSigma();
  result.time = keyframe.time;
  result.planes = Run(keyframe, config_).planes();
  return result;
}

}  // namespace sgraphs
