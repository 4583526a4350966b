#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "lcmtypes/convert/convert.h"
#include "tests/lcmtypes/through_bytes.h"

namespace sgraphs {
namespace {

using test::throughBytes;

KeyframePlanes somePlanes(size_t planes, size_t corners) {
  KeyframePlanes result;
  result.keyframe = KeyframeId{42};
  result.time = Time{1'700'000'000'100'000};
  for (size_t i = 0; i < planes; ++i) {
    const auto t = static_cast<double>(i);
    PlaneObservation plane;
    plane.normal_body = Eigen::Vector3d(std::cos(t), std::sin(t), 0.3).normalized();
    plane.centroid_body = {-3 - t, 0.5 * t, 1.25};
    plane.covariance << 4e-6, 1e-7, 2e-7, 1e-7, 5e-6, 3e-7, 2e-7, 3e-7, 9e-6;
    plane.num_points = 1000 + static_cast<int>(i);
    plane.rms_m = 0.0125f;
    plane.area_m2 = 7.5f;
    for (size_t c = 0; c < corners; ++c) {
      const float angle = 6.2831853f * static_cast<float>(c) / static_cast<float>(corners);
      plane.boundary.emplace_back(2 * std::cos(angle), std::sin(angle));
    }
    result.planes.push_back(plane);
  }
  return result;
}

TEST(ConvertPlanesTest, RoundTripIsExactFromNoPlaneToTheMost) {
  for (const auto& [planes, corners] : {std::pair<size_t, size_t>{0, 3}, {1, 3}, {7, 12}, {64, 48}}) {
    const KeyframePlanes before = somePlanes(planes, corners);
    const keyframe_planes_t message = toMessage(before);
    EXPECT_LE(message.getEncodedSize(), test::kDatagramBytes);
    const auto after = fromMessage(throughBytes(message));
    ASSERT_TRUE(after) << planes;
    EXPECT_EQ(after->keyframe, before.keyframe);
    EXPECT_EQ(after->time, before.time);
    ASSERT_EQ(after->planes.size(), planes);
    for (size_t i = 0; i < planes; ++i) {
      const PlaneObservation &a = after->planes[i], &b = before.planes[i];
      EXPECT_EQ(a.normal_body, b.normal_body);
      EXPECT_EQ(a.centroid_body, b.centroid_body);
      EXPECT_EQ(a.covariance, b.covariance);
      EXPECT_EQ(a.num_points, b.num_points);
      EXPECT_EQ(a.rms_m, b.rms_m);
      EXPECT_EQ(a.area_m2, b.area_m2);
      EXPECT_EQ(a.boundary, b.boundary);
    }
  }
}

TEST(ConvertPlanesTest, MoreThanAMessageHoldsIsAProgrammingError) {
  EXPECT_THROW(toMessage(somePlanes(65, 3)), std::logic_error);
  EXPECT_THROW(toMessage(somePlanes(1, 49)), std::logic_error);
}

TEST(ConvertPlanesTest, ContentThatCannotBeIsRefused) {
  const std::vector<std::function<void(keyframe_planes_t&)>> spoilings{
      [](keyframe_planes_t& m) { m.keyframe = -1; },
      [](keyframe_planes_t& m) { m.planes[1].normal[0] = NAN; },
      [](keyframe_planes_t& m) { m.planes[1].normal[2] += 0.01; },
      [](keyframe_planes_t& m) { m.planes[1].centroid[1] = INFINITY; },
      [](keyframe_planes_t& m) { m.planes[1].covariance[3] = -1e-6; },
      [](keyframe_planes_t& m) { m.planes[1].covariance[0] = 0; },
      [](keyframe_planes_t& m) { m.planes[1].covariance[1] = 1; },
      [](keyframe_planes_t& m) { m.planes[1].covariance[5] = NAN; },
      [](keyframe_planes_t& m) { m.planes[1].num_points = 0; },
      [](keyframe_planes_t& m) { m.planes[1].rms_m = -0.1f; },
      [](keyframe_planes_t& m) { m.planes[1].rms_m = NAN; },
      [](keyframe_planes_t& m) { m.planes[1].area_m2 = -1; },
      [](keyframe_planes_t& m) { m.planes[1].boundary[2][1] = NAN; },
      [](keyframe_planes_t& m) {
        m.planes[1].boundary.resize(2);
        m.planes[1].num_corners = 2;
      },
      [](keyframe_planes_t& m) {
        m.planes[1].boundary.resize(49, m.planes[1].boundary[0]);
        m.planes[1].num_corners = 49;
      },
      [](keyframe_planes_t& m) {
        m.planes.resize(65, m.planes[0]);
        m.num_planes = 65;
      }};
  for (size_t i = 0; i < spoilings.size(); ++i) {
    keyframe_planes_t message = toMessage(somePlanes(3, 5));
    ASSERT_TRUE(fromMessage(throughBytes(message)));
    spoilings[i](message);
    EXPECT_FALSE(fromMessage(throughBytes(message))) << i;
  }
}

}  // namespace
}  // namespace sgraphs
