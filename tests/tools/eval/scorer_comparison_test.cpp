#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>

#include "tests/support/temp_folder.h"
#include "tests/tools/eval/truth_fixture.h"
#include "tools/eval/trajectory_error.h"

namespace sgraphs {
namespace {

std::string outputOf(const std::string& command) {
  std::string output;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return output;
  std::array<char, 256> part;
  while (std::fgets(part.data(), part.size(), pipe)) output += part.data();
  pclose(pipe);
  return output;
}

// The independent scorer says the same.
TEST(ScorerComparisonTest, AbsoluteErrorAgreesWithTheIndependentScorer) {
  const std::string scorer = std::string(SGRAPHS_SHARED_DATA_DIR) + "/../tools/score.py";
  if (!std::filesystem::exists(scorer)) GTEST_SKIP() << scorer << " is absent";
  if (std::system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0) GTEST_SKIP() << "no python3-numpy";
  const auto truth = test::curvedTruth();
  auto estimate = test::everyNth(truth, 7, test::kSomeTransform);
  std::mt19937 random(11);
  Eigen::Vector3d drift = Eigen::Vector3d::Zero();
  for (auto& pose : estimate) {
    drift += test::gaussian(random, 0.01);
    pose.time = pose.time + Duration{3'210};
    pose.pose.translation += drift;
  }
  const test::TempFolder folder;
  const std::string gt = folder / "gt.tum", est = folder / "est.tum";
  writeTum(gt, truth);
  writeTum(est, estimate);
  const std::string output = outputOf("/usr/bin/python3 " + scorer + " ate " + gt + " " + est);
  double rmse = 0, max = 0;
  int count = 0;
  ASSERT_EQ(std::sscanf(output.c_str(), "ate_rmse_m %lf max %lf n %d", &rmse, &max, &count), 3) << output;
  const auto ours = absoluteError(readTum(gt), readTum(est)).translation_m;
  EXPECT_EQ(static_cast<int>(ours.count), count);
  EXPECT_NEAR(ours.rmse, rmse, 5.1e-5);  // it prints four decimals
  EXPECT_NEAR(ours.max, max, 5.1e-5);
  EXPECT_GT(rmse, 0.01);
}

}  // namespace
}  // namespace sgraphs
