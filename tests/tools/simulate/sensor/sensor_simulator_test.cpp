#include "tools/simulate/sensor/sensor_simulator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/degree.h"
#include "drivers/velodyne/vlp16_decoder.h"
#include "tools/simulate/scene/scene_file.h"
#include "tools/simulate/scene/test_worlds.h"

namespace sgraphs::simulate {
namespace {

SE3 mount() {
  return {so3Exp({0.02, 0.035, 1.2}), {0.12, 0.03, 0.31}};
}

Scene furnishedRoom() {
  Scene scene = makeBoxRoom(6, 5, 2.7);
  scene.boxes.push_back({"table", {4.6, 3.6}, {1.2, 0.8}, 0, 0.7, 0.4});
  scene.path.waypoints = {{{1.2, 1.2}, 0}, {{3.4, 1.4}, 0}, {{2.6, 3.8}, 0}};
  scene.path.start_pause_s = 0.5;
  scene.path.end_pause_s = 0.5;
  return scene;
}

class SensorSimulatorTest : public testing::Test {
 protected:
  SensorSimulator sensor(const SensorModel& model, uint64_t seed = 3) const {
    return {world_.caster, walk_, mount(), model, seed};
  }
  // Revolutions as the driver makes them of the packets.
  std::vector<LidarScan> decode(const SensorSimulator& from, int64_t first, int64_t count) const {
    RevolutionAssembler assembler;
    std::vector<LidarScan> scans;
    for (const SensorPacket& packet : from.packets(first, count, 2))
      if (auto scan = assembler.step(packet.time, packet.bytes)) scans.push_back(*scan);
    for (const int64_t rejected : assembler.counts().rejected) EXPECT_EQ(rejected, 0);
    EXPECT_EQ(assembler.counts().lost_packets, 0);
    return scans;
  }

  const SimulatedWorld world_{furnishedRoom()};
  const Trajectory walk_ = walkAlong(world_.scene.path, world_.scene.start, 0);
};

TEST_F(SensorSimulatorTest, DecodedPointsLieOnTheMeshWithExactPoses) {
  const SensorSimulator noise_free = sensor(SensorModel::noiseFree());
  const auto scans = decode(noise_free, 2200, 450);  // in the middle of the walk
  ASSERT_GE(scans.size(), 4u);
  double sum = 0, worst = 0;
  int64_t count = 0;
  for (const LidarScan& scan : scans)
    for (const LidarPoint& point : scan.points) {
      const SE3 T_building_lidar = noise_free.lidarPoseAt(scan.end + Duration{point.time_us});
      const double distance = world_.caster.distanceToSurface(
          T_building_lidar * Eigen::Vector3d(point.position_lidar.cast<double>()));
      worst = std::max(worst, distance);
      sum += distance * distance;
      ++count;
    }
  // Half a range step, and half a step of the reported azimuth (0.005 deg) at up to 6 m.
  EXPECT_LT(worst, 0.001 + 6.5 * 0.005 * kDegree_rad + 1e-4);
  EXPECT_LT(std::sqrt(sum / static_cast<double>(count)), 0.0006);
  EXPECT_GT(count, 4 * 25000);
}

TEST_F(SensorSimulatorTest, ScansEqualTheDecodedPackets) {
  const SensorSimulator noisy = sensor(SensorModel());
  const auto decoded = decode(noisy, 0, 300);
  ASSERT_GE(decoded.size(), 2u);
  // The decoder drops what lies before the first cut it sees: revolution 0.
  for (int k = 1; k <= 2; ++k) {
    const LidarScan made = noisy.scan(k);
    const LidarScan& seen = decoded[static_cast<size_t>(k - 1)];
    EXPECT_LE(std::abs((made.end - seen.end).us), 112);  // cuts lie between blocks: within one block
    size_t i = 0, j = 0, compared = 0;
    while (i < made.points.size() && j < seen.points.size()) {
      const auto &p = made.points[i], &q = seen.points[j];
      const int64_t dt = (made.end - seen.end).us + p.time_us - q.time_us;
      if (std::abs(dt) <= 1) {
        EXPECT_EQ(p.ring, q.ring);
        EXPECT_EQ(p.reflectivity, q.reflectivity);
        EXPECT_LT((p.position_lidar - q.position_lidar).norm(), 1e-3);
        ++compared, ++i, ++j;
      } else {
        (dt < 0 ? i : j) += 1;
      }
    }
    EXPECT_GT(compared, made.points.size() - 100);
  }
}

TEST_F(SensorSimulatorTest, PacketsDoNotDependOnThreadsOrOrder) {
  const SensorSimulator noisy = sensor(SensorModel());
  const auto one = noisy.packets(40, 100, 1), many = noisy.packets(40, 100, 5);
  ASSERT_EQ(one.size(), many.size());
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].time, many[i].time);
    EXPECT_EQ(one[i].bytes, many[i].bytes);
  }
  EXPECT_EQ(noisy.packet(90).bytes, one[50].bytes);
  EXPECT_EQ(sensor(SensorModel()).packet(90).bytes, one[50].bytes);
  EXPECT_NE(sensor(SensorModel(), 4).packet(90).bytes, one[50].bytes);
}

TEST_F(SensorSimulatorTest, StampsAndAzimuthsAdvanceAsTheManualSays) {
  const SensorSimulator exact = sensor(SensorModel::noiseFree());
  for (const int64_t k : {0, 1, 2, 777, 1500}) {
    const SensorPacket packet = exact.packet(k);
    const auto offset_us = std::llround(static_cast<double>(k) * 1327.104);
    EXPECT_EQ((packet.time - walk_.start()).us, offset_us);
    Vlp16Packet parsed;
    ASSERT_EQ(parsePacket(packet.bytes, parsed), PacketFault::kNone);
    EXPECT_EQ(parsed.mode, ReturnMode::kStrongest);
    EXPECT_EQ(packet.bytes[1205], 0x22);
    EXPECT_EQ(parsed.stamp_us, (walk_.start().us + offset_us) % 3600000000);
    for (int block = 0; block < kVlp16Blocks; ++block) {
      const double turned_cdeg = 0.36 * (static_cast<double>(k) * 1327.104 + block * 110.592);
      EXPECT_LE(
          std::abs(std::remainder(parsed.azimuth_cdeg[static_cast<size_t>(block)] - turned_cdeg, 36000.0)),
          0.51);
    }
  }
  EXPECT_EQ(exact.numPackets(), static_cast<int64_t>(walk_.duration().seconds() / 1327.104e-6));
}

TEST_F(SensorSimulatorTest, StampWrapsWithTheHour) {
  EXPECT_EQ(microsecondsPastHour(Time{3600000000LL * 5 - 1}), 3599999999u);
  EXPECT_EQ(microsecondsPastHour(Time{3600000000LL * 5}), 0u);
}

TEST_F(SensorSimulatorTest, RangeNoiseHasTheStatedDeviation) {
  SensorModel noisy = SensorModel::noiseFree();
  noisy.range_sigma_m = 0.015;
  const SE3 T(Eigen::Quaterniond::Identity(), {2, 2, 1});
  const auto exact = simulateScan(world_, T), shaken = simulateScan(world_, T, noisy, 9);
  ASSERT_EQ(exact.points.size(), shaken.points.size());
  double sum = 0, squares = 0;
  for (size_t i = 0; i < exact.points.size(); ++i) {
    const double e = shaken.points[i].position_lidar.norm() - exact.points[i].position_lidar.norm();
    sum += e;
    squares += e * e;
  }
  const double n = static_cast<double>(exact.points.size());
  EXPECT_NEAR(sum / n, 0.0, 5 * 0.015 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.015, 0.0005);
}

TEST(SensorModelTest, GrazingReturnsAreLostAndOthersKept) {
  const SimulatedWorld corridor(makeCorridor(60, 2));
  const SE3 T(Eigen::Quaterniond::Identity(), {30, 1, 1});
  SensorModel dropping = SensorModel::noiseFree();
  dropping.grazing_drop_deg = 80;
  const auto all = simulateScan(corridor, T), some = simulateScan(corridor, T, dropping, 5);
  // Incidence on a side wall is the angle from its normal, here from the y axis; floor and ceiling likewise.
  const auto grazing = [](const LidarScan& scan, double from_deg, double to_deg) {
    int count = 0;
    for (const LidarPoint& p : scan.points) {
      const Eigen::Vector3f u = p.position_lidar.normalized();
      if (std::abs(std::abs(p.position_lidar.y()) - 1.0f) > 0.002f) continue;
      const double incidence = std::acos(std::abs(u.y())) / kDegree_rad;
      count += incidence > from_deg && incidence < to_deg;
    }
    return count;
  };
  EXPECT_EQ(grazing(some, 0, 79.5), grazing(all, 0, 79.5));
  EXPECT_NEAR(grazing(some, 84, 86) / static_cast<double>(grazing(all, 84, 86)), 0.75, 0.15);
  EXPECT_LT(some.points.size(), all.points.size());
}

TEST(SensorModelTest, NothingIsReturnedFromBeyondTheMaximumRange) {
  const SimulatedWorld corridor(makeCorridor(60, 2));
  SensorModel near_sighted = SensorModel::noiseFree();
  near_sighted.max_range_m = 10;
  const SE3 T(Eigen::Quaterniond::Identity(), {30, 1, 1});
  for (const LidarPoint& p : simulateScan(corridor, T, near_sighted).points)
    EXPECT_LT(p.position_lidar.norm(), 10.02);
}

TEST(SensorModelTest, RevolutionOfAMovingSensorIsDeskewedByItsTwist) {
  const SimulatedWorld room(makeBoxRoom(5, 4));
  const SE3 start(so3Exp({0.02, -0.01, 0.5}), {2, 2, 1});
  Vector6d twist;
  twist << 1.0, 0.2, -0.1, 0.1, 0.2, 0.8;
  const LidarScan scan = simulateMovingScan(room, start, twist);
  ASSERT_GT(scan.points.size(), 28000u);
  double worst = 0;
  for (const LidarPoint& p : scan.points) {
    const double seconds = (scan.end - scan.begin).seconds() + p.time_us * 1e-6;
    const SE3 T = start * se3Exp(seconds * twist);
    worst =
        std::max(worst, room.caster.distanceToSurface(T * Eigen::Vector3d(p.position_lidar.cast<double>())));
  }
  EXPECT_LT(worst, 0.0011);
}

// A room of 10 x 4 m whose half beyond x = 6 lies behind glass.
Scene roomBehindGlass() {
  Scene scene = makeBoxRoom(10, 4);
  Wall pane{{6, 0}, {6, 4}, 0.1, 0, 2.8};
  pane.glass = true;
  scene.walls.push_back(pane);
  return scene;
}

TEST(GlassTest, ReturnsComeNearNormalIncidenceOnlyAndWeak) {
  const SimulatedWorld world(roomBehindGlass());
  const Eigen::Vector3d eye(3, 2, 1.4);
  int normal = 0, normal_seen = 0, oblique = 0, oblique_seen = 0;
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const auto scan =
        simulateScan(world, {Eigen::Quaterniond::Identity(), eye}, SensorModel::noiseFree(), seed);
    for (const LidarPoint& p : scan.points) {
      const Eigen::Vector3d way = p.position_lidar.cast<double>(), at = eye + way;
      const bool on_other = at.y() < 0.01 || at.y() > 3.99 || at.z() < 0.01 || at.z() > 2.79;
      const bool on_pane = std::abs(at.x() - 6) < 0.002 && !on_other;
      if (!on_pane && way.x() < 3.01) continue;
      if (on_pane) {
        EXPECT_LE(p.reflectivity, 5);
      }
      const double incidence_deg = std::acos(way.normalized().x()) / kDegree_rad;
      if (incidence_deg < 3) {
        ++normal;
        normal_seen += on_pane;
      } else if (incidence_deg > 12.2) {
        ++oblique;
        oblique_seen += on_pane;
      }
    }
  }
  ASSERT_GT(normal, 150);
  ASSERT_GT(oblique, 3000);
  EXPECT_EQ(oblique_seen, 0);
  // 0.8 (1 - (i / 12 deg)^2), i up to 3 deg.
  EXPECT_NEAR(normal_seen / static_cast<double>(normal), 0.78, 0.12);
}

TEST(GlassTest, WhatGoesThroughMeasuresTheWallBehindWithLessLight) {
  const SimulatedWorld behind(roomBehindGlass()), open(makeBoxRoom(10, 4));
  const SE3 T(Eigen::Quaterniond::Identity(), {3, 2, 1.4});
  const auto through = simulateScan(behind, T), free = simulateScan(open, T);
  size_t j = 0, same = 0, dimmer = 0;
  for (const LidarPoint& p : through.points) {
    while (j < free.points.size() && (free.points[j].column != p.column || free.points[j].ring != p.ring))
      ++j;
    ASSERT_LT(j, free.points.size());
    const LidarPoint& q = free.points[j];
    if (p.position_lidar.x() <= 3.01f) continue;  // this side of the pane, or on it
    EXPECT_LT((p.position_lidar - q.position_lidar).norm(), 1e-6);
    ++same;
    dimmer += p.reflectivity < q.reflectivity;
  }
  EXPECT_GT(same, 1000u);
  EXPECT_EQ(dimmer, same);
}

TEST(GlassTest, FlatRaysAreThrownAwayAndPacketsAreReproducible) {
  // Along a pane at 0.2 m: beyond 80 degrees of incidence nothing comes through.
  Scene scene = makeBoxRoom(20, 4);
  Wall pane{{0, 2.2}, {20, 2.2}, 0.1, 0, 2.8};
  pane.glass = true;
  scene.walls.push_back(pane);
  const SimulatedWorld world(scene);
  const SE3 T(Eigen::Quaterniond::Identity(), {2, 2, 1.4});
  int through = 0;
  for (const LidarPoint& p : simulateScan(world, T).points) {
    const Eigen::Vector3f u = p.position_lidar.normalized();
    if (p.position_lidar.y() < 0.21f) continue;
    EXPECT_LT(std::acos(u.y()) / kDegree_rad, 80);
    ++through;
  }
  EXPECT_GT(through, 1000);
  const auto still = Trajectory::still(world.scene.start, Duration{200000}, T);
  const SensorSimulator one(world.caster, still, SE3(), {}, 4), two(world.caster, still, SE3(), {}, 4);
  const auto a = one.packets(0, 60, 1), b = two.packets(0, 60, 3);
  for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].bytes, b[i].bytes);
}

TEST(PeopleInTheScanTest, SensorSeesThemWhereTheyAreAtTheFiring) {
  const SimulatedWorld world(makeBoxRoom(10, 8));
  Person person;
  person.waypoints = {{5, 1}, {5, 7}};
  person.speed_mps = 2.0;
  const SE3 T(Eigen::Quaterniond::Identity(), {1, 4, 1.2});
  const auto still = Trajectory::still(world.scene.start, Duration{3000000}, T);
  const SensorSimulator sensor(world.caster, still, SE3(), SensorModel::noiseFree(), 0,
                               People({person}, world.scene.floors_z_m));
  int on_person = 0;
  for (const int64_t k : {0, 7, 14, 21}) {
    const LidarScan scan = sensor.scan(k);
    for (const LidarPoint& p : scan.points) {
      const Eigen::Vector3d at = T * Eigen::Vector3d(p.position_lidar.cast<double>());
      if (world.caster.distanceToSurface(at) < 0.01) continue;
      const double seconds = (scan.end + Duration{p.time_us} - world.scene.start).seconds();
      const double z = at.z(), height = person.height_m;
      // The trunk, which is round its place at that instant.
      if (z < 0.48 * height || z > 0.85 * height) continue;
      const Eigen::Vector2d center(5, 1 + 2.0 * seconds);
      EXPECT_NEAR((at.head<2>() - center).norm(), person.radius_m, 0.0015) << k;
      ++on_person;
    }
  }
  EXPECT_GT(on_person, 100);
}

}  // namespace
}  // namespace sgraphs::simulate
