#include <gtest/gtest.h>

#include <functional>

#include "lcmtypes/convert/convert.h"
#include "tests/lcmtypes/through_bytes.h"

namespace sgraphs {
namespace {

using test::kNaN;

MapPlane somePlane() {
  MapPlane plane;
  plane.id = {12};
  plane.floor = {1};
  plane.label = PlaneLabel::kX;
  plane.normal_map = Eigen::Vector3d(-0.9, 0.3, 0.1).normalized();
  plane.centroid_map = {4.0, -2.0, 1.5};
  plane.d = -plane.normal_map.dot(plane.centroid_map);
  plane.covariance << 4e-6, 1e-6, 2e-6, 1e-6, 9e-6, -1e-6, 2e-6, -1e-6, 1e-4;
  plane.polygon_map = {{4, -3, 0}, {4, -1, 0}, {4, -1, 2.5f}};
  return plane;
}

TEST(ConvertMapPlaneTest, RoundTripIsExact) {
  const MapPlane plane = somePlane();
  const auto read = fromMessage(test::throughBytes(toMessage(plane)));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->id, plane.id);
  EXPECT_EQ(read->merged_into, PlaneId{});
  EXPECT_EQ(read->floor, plane.floor);
  EXPECT_EQ(read->label, plane.label);
  EXPECT_EQ(read->normal_map, plane.normal_map);
  EXPECT_EQ(read->d, plane.d);
  EXPECT_EQ(read->centroid_map, plane.centroid_map);
  EXPECT_EQ(read->covariance, plane.covariance);
  EXPECT_EQ(read->polygon_map, plane.polygon_map);
}

TEST(ConvertMapPlaneTest, AMergedPlaneIsItsTwoIds) {
  MapPlane plane = somePlane();
  plane.merged_into = {3};
  const auto read = fromMessage(test::throughBytes(toMessage(plane)));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->id, plane.id);
  EXPECT_EQ(read->merged_into, PlaneId{3});
}

TEST(ConvertMapPlaneTest, WhatIsNoPlaneIsRefused) {
  const std::function<void(graph_plane_t&)> faults[] = {
      [](graph_plane_t& m) { m.id = -1; },
      [](graph_plane_t& m) { m.merged_into = m.id; },
      [](graph_plane_t& m) { m.merged_into = -2; },
      [](graph_plane_t& m) { m.floor = -2; },
      [](graph_plane_t& m) { m.label = 0; },
      [](graph_plane_t& m) { m.label = 4; },
      [](graph_plane_t& m) { m.normal[1] = kNaN; },
      [](graph_plane_t& m) { m.normal[0] *= 1.1; },
      [](graph_plane_t& m) { m.d += 0.1; },
      [](graph_plane_t& m) { m.centroid[2] = kNaN; },
      [](graph_plane_t& m) { m.covariance[3] = -1e-6; },
      [](graph_plane_t& m) { m.covariance[5] = kNaN; },
      [](graph_plane_t& m) { m.polygon[1][1] = static_cast<float>(kNaN); },
      [](graph_plane_t& m) {
        m.polygon.resize(2);
        m.num_corners = 2;
      },
  };
  int index = 0;
  for (const auto& fault : faults) {
    graph_plane_t m = toMessage(somePlane());
    ASSERT_TRUE(fromMessage(m));
    fault(m);
    EXPECT_FALSE(fromMessage(m)) << "fault " << index;
    ++index;
  }
}

TEST(ConvertMapPlaneTest, TooManyCornersAreAnError) {
  MapPlane plane = somePlane();
  plane.polygon_map.assign(kMaxMapPlaneCorners, {4, -3, 0});
  EXPECT_TRUE(fromMessage(test::throughBytes(toMessage(plane))));
  plane.polygon_map.emplace_back(4, -3, 0);
  EXPECT_THROW(toMessage(plane), std::logic_error);
}

}  // namespace
}  // namespace sgraphs
