#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/types/keyframe.h"
#include "perception/planes/planes_config.h"

namespace sgraphs {

// A voxel centroid of the keyframe's cloud, as the segmentation sees it; all in the keyframe's body.
struct ViewedPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d to_viewpoint = Eigen::Vector3d::UnitX();  // unit
  double range_m = 0;                                       // from the viewpoint
  int count = 1;                                            // raw points
  uint8_t scan = 0;
  bool explained = false;  // lies on a plane found, whatever its own normal
  int32_t facet = -1;      // into FacetCloud::facets; -1: no normal
};

// Sums that a plane can be fitted to.
struct PlaneMoments {
  double weight = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d outer = Eigen::Matrix3d::Zero();

  void add(const Eigen::Vector3d& p, double w) {
    weight += w;
    sum += w * p;
    outer += (w * p) * p.transpose();
  }
  void add(const PlaneMoments& other) {
    weight += other.weight;
    sum += other.sum;
    outer += other.outer;
  }
  Eigen::Vector3d mean() const { return sum / weight; }
  Eigen::Matrix3d covariance() const { return outer / weight - mean() * mean().transpose(); }
};

// The points of one cell that were seen from the same side of the surface through it. A thin wall seen from
// both sides has two facets per cell, back to back.
struct Facet {
  PlaneMoments moments;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, towards the viewpoints
  double area_m2 = 0;                                // of its cell
};

struct FacetCloud {
  std::vector<ViewedPoint> points;
  std::vector<Facet> facets;
  double thickness_m = 0;  // median standard deviation of the surfaces: the noise of this cloud
};

// The surface's direction comes from the points of a cell and its 26 neighbours, its sign from each point's
// own viewpoint. Cells grow with the range, since the rings of a LiDAR spread out. Points on edges and in
// clutter have no normal and belong to no facet.
FacetCloud makeFacets(const Keyframe& keyframe, const FacetConfig& config);

}  // namespace sgraphs
