// Real recordings: two VLP-16s indoors, and a pair of unorganised outdoor scans.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>

#include "drivers/recording/packet_source.h"
#include "drivers/recording/scan_folder.h"
#include "drivers/velodyne/vlp16_decoder.h"
#include "perception/odometry/odometry.h"
#include "perception/odometry/registration.h"
#include "tests/perception/odometry/simulated_walk.h"

namespace sgraphs {
namespace {

using namespace testing_support;

const std::string kData = SGRAPHS_SHARED_DATA_DIR;
const std::string kRaw = kData + "/vlp16/einride_recording.bin";
const std::string kPcap = kData + "/vlp16/veloview_vlp-16-test-90deg-1-50-frames.pcap";
const std::string kPair = kData + "/scans/small_gicp_kitti_like";

std::vector<LidarScan> readScans(const std::string& path) {
  std::unique_ptr<PacketSource> source;
  if (path.ends_with(".pcap"))
    source = std::make_unique<PcapPacketSource>(path);
  else
    source = std::make_unique<RawPacketSource>(path, Time{1'700'000'000'000'000});
  RevolutionAssembler assembler;
  std::vector<LidarScan> scans;
  while (const auto packet = source->next())
    if (auto scan = assembler.step(packet->time, packet->bytes)) scans.push_back(std::move(*scan));
  return scans;
}

// A sensor on a tripod: it is its own body, and nothing of it is in its view.
OdometryConfig tripod() {
  OdometryConfig config;
  PrefilterConfig& p = config.prefilter;
  p.body_min_x_m = p.body_min_y_m = p.body_min_z_m = -0.01;
  p.body_max_x_m = p.body_max_y_m = p.body_max_z_m = 0.01;
  // Rooms are small: patches must reach their radius on surfaces a metre away too.
  config.surfels.max_half_columns = 30;
  return config;
}

std::vector<OdometryEstimate> follow(const std::vector<LidarScan>& scans) {
  Odometry odometry(tripod(), OdometryMode::kLidar, SE3());
  std::vector<OdometryEstimate> estimates;
  for (const LidarScan& scan : scans)
    if (const auto estimate = odometry.step(scan, {})) estimates.push_back(*estimate);
  return estimates;
}

double largestDrift(const std::vector<OdometryEstimate>& estimates) {
  double drift = 0;
  for (const OdometryEstimate& e : estimates) drift = std::max(drift, e.T_odom_body.translation.norm());
  return drift;
}

double meanInlierShare(const std::vector<OdometryEstimate>& estimates) {
  double sum = 0;
  for (size_t i = 1; i < estimates.size(); ++i) sum += estimates[i].inlier_share;
  return sum / static_cast<double>(estimates.size() - 1);
}

double meanRms(const std::vector<OdometryEstimate>& estimates) {
  double sum = 0;
  for (size_t i = 1; i < estimates.size(); ++i) sum += estimates[i].residual_rms_m;
  return sum / static_cast<double>(estimates.size() - 1);
}

class StillSensorTest : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(GetParam())) GTEST_SKIP() << "needs " << GetParam();
    scans_ = readScans(GetParam());
    ASSERT_GE(scans_.size(), 10u);
    // The sensor of the capture begins to roll in its last second; see MovingSensorTest.
    scans_.resize(std::min<size_t>(scans_.size(), 26));
  }
  std::vector<LidarScan> scans_;
};

TEST_P(StillSensorTest, DriftsLessThanACentimetre) {
  const auto estimates = follow(scans_);
  ASSERT_EQ(estimates.size(), scans_.size());
  std::printf("drift %.1f mm, inlier share %.3f, residual rms %.1f mm, %zu scans\n",
              1e3 * largestDrift(estimates), meanInlierShare(estimates), 1e3 * meanRms(estimates),
              scans_.size());
  EXPECT_LT(largestDrift(estimates), 0.01);
  // Not 0.9: beyond 2 m nearly every patch finds its surface, but more than half of these rooms' patches lie
  // nearer, where normals scatter beyond the gate.
  EXPECT_GE(meanInlierShare(estimates), 0.83);
  EXPECT_LT(meanRms(estimates), 0.01);
  for (const OdometryEstimate& e : estimates) EXPECT_FALSE(e.extrapolated);
}

TEST_P(StillSensorTest, SensorTurnedByAQuarterGivesTheSame) {
  const SE3 turn = poseOf({0, 0, 0}, 0, 0, 90);
  const auto estimates = follow(scans_);
  for (LidarScan& scan : scans_)
    for (LidarPoint& p : scan.points)
      p.position_lidar = (turn * p.position_lidar.cast<double>()).cast<float>();
  const auto turned = follow(scans_);
  ASSERT_EQ(turned.size(), estimates.size());
  EXPECT_LT(largestDrift(turned), 0.01);
  for (size_t i = 0; i < turned.size(); ++i)
    EXPECT_LT(distance(turned[i].T_odom_body, turn * estimates[i].T_odom_body * turn.inverse()), 0.004);
}

TEST_P(StillSensorTest, FollowsAStepOfFiveCentimetres) {
  const Eigen::Vector3f step(0.04f, -0.03f, 0);
  for (size_t i = scans_.size() / 2; i < scans_.size(); ++i)
    for (LidarPoint& p : scans_[i].points) p.position_lidar -= step;
  const auto estimates = follow(scans_);
  ASSERT_EQ(estimates.size(), scans_.size());
  EXPECT_LT(estimates[scans_.size() / 2 - 1].T_odom_body.translation.norm(), 0.01);
  const Eigen::Vector3d end = estimates.back().T_odom_body.translation;
  EXPECT_LT((end - step.cast<double>()).norm(), 0.01) << end.transpose();
}

INSTANTIATE_TEST_SUITE_P(Vlp16, StillSensorTest, testing::Values(kRaw, kPcap),
                         [](const auto& named) { return named.index == 0 ? "raw" : "pcap"; });

// Each scan against the first by itself, the sensor taken as still during it, is another way to the motion.
TEST(MovingSensorTest, OdometryAgreesWithRegistrationToTheFirstScan) {
  if (!std::filesystem::exists(kPcap)) GTEST_SKIP() << "needs " << kPcap;
  const std::vector<LidarScan> scans = readScans(kPcap);
  const auto estimates = follow(scans);
  ASSERT_EQ(estimates.size(), scans.size());
  const auto patches = [](const LidarScan& scan) {
    return extractSurfels(scan, prefilter(scan, SE3(), tripod().prefilter), SE3(), tripod().surfels, 1);
  };
  const SurfelMap map = mapOf(patches(scans[0]), SE3());
  for (size_t i = 5; i < scans.size(); i += 4) {
    SE3 T_first_scan;
    registerRigid(patches(scans[i]), map, Matrix6d::Zero(), RegistrationConfig(), 1, T_first_scan);
    EXPECT_LT(distance(estimates[i].T_odom_body, T_first_scan), 0.02) << "scan " << i;
    EXPECT_LT(angle(estimates[i].T_odom_body, T_first_scan), 0.01) << "scan " << i;
  }
  EXPECT_GT(estimates.back().T_odom_body.translation.x(), 0.1) << "the sensor did move";
}

LidarScan readCloud(const std::string& path) {
  LidarScan scan;
  for (const Eigen::Vector3f& p : readPoints(path)) {
    LidarPoint point;
    point.position_lidar = p;
    scan.points.push_back(point);
  }
  return scan;
}

TEST(ScanPairTest, OutdoorPairIsRegisteredToWithinTenCentimetres) {
  if (!std::filesystem::exists(kPair)) GTEST_SKIP() << "needs " << kPair;
  Eigen::Matrix4d T;
  std::ifstream file(kPair + "/T_target_source.txt");
  for (int i = 0; i < 16; ++i) ASSERT_TRUE(file >> T(i / 4, i % 4));
  const SE3 truth(Eigen::Quaterniond(Eigen::Matrix3d(T.topLeftCorner<3, 3>())), T.topRightCorner<3, 1>());
  const auto patches = [](const std::string& name) {
    const LidarScan scan = readCloud(kPair + "/" + name);
    return extractSurfels(scan, prefilter(scan, SE3(), tripod().prefilter), SE3(), SurfelConfig(), 1);
  };
  const std::vector<Surfel> target = patches("target.ply"), source = patches("source.ply");
  RegistrationConfig config;
  config.gate_m = 1.0;  // half a metre between the scans, and no guess
  config.max_iterations = 50;
  SE3 T_target_source;
  const RegistrationResult result =
      registerRigid(source, mapOf(target, SE3()), Matrix6d::Zero(), config, 1, T_target_source);
  const double error_m = distance(T_target_source, truth);
  const double error_deg = angle(T_target_source, truth) * 180 / M_PI;
  std::printf("%zu and %zu patches, %d matches, inlier share %.2f: %.1f mm, %.3f deg off\n", target.size(),
              source.size(), result.matches, result.inlier_share, 1e3 * error_m, error_deg);
  EXPECT_LT(error_m, 0.10);
  EXPECT_LT(error_deg, 0.5);
}

}  // namespace
}  // namespace sgraphs
