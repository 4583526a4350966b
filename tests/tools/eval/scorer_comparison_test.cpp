#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>

#include "tests/support/temp_folder.h"
#include "tests/tools/eval/house.h"
#include "tests/tools/eval/truth_fixture.h"
#include "tools/eval/evaluate.h"
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
const std::string kScorer = std::string(SGRAPHS_SHARED_DATA_DIR) + "/../tools/score.py";

// Why the scorer cannot run; empty if it can.
std::string whyNoScorer(const std::string& modules) {
  if (!std::filesystem::exists(kScorer)) return kScorer + " is absent";
  const std::string import = "/usr/bin/python3 -c 'import " + modules + "' 2>/dev/null";
  return std::system(import.c_str()) == 0 ? "" : "/usr/bin/python3 has no " + modules;
}

TEST(ScorerComparisonTest, AbsoluteErrorAgreesWithTheIndependentScorer) {
  const std::string why = whyNoScorer("numpy");
  if (!why.empty()) GTEST_SKIP() << why;
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
  const std::string output = outputOf("/usr/bin/python3 " + kScorer + " ate " + gt + " " + est);
  double rmse = 0, max = 0;
  int count = 0;
  ASSERT_EQ(std::sscanf(output.c_str(), "ate_rmse_m %lf max %lf n %d", &rmse, &max, &count), 3) << output;
  const auto ours = absoluteError(readTum(gt), readTum(est)).translation_m;
  EXPECT_EQ(static_cast<int>(ours.count), count);
  EXPECT_NEAR(ours.rmse, rmse, 5.1e-5);  // it prints four decimals
  EXPECT_NEAR(ours.max, max, 5.1e-5);
  EXPECT_GT(rmse, 0.01);
}

// A house with rooms that are good, too small, doubled, in a corridor, and one made up.
TEST(ScorerComparisonTest, RoomsAgreeWithTheIndependentScorer) {
  const std::string why = whyNoScorer("numpy, matplotlib");
  if (!why.empty()) GTEST_SKIP() << why;
  const test::House house;
  EstimatedGraph graph = house.graph(test::kMapOfHouse);
  graph.rooms.clear();
  const auto add = [&](const Corners& polygon, size_t floor) {
    test::House::addRoom(graph, polygon, floor, test::kMapOfHouse);
  };
  add(test::box(0.1, 0.1, 4.05, 3.9), 0);  // R1
  add(test::box(4.2, 0, 8.2, 4), 0);       // R2 with its notch
  add(test::box(0.4, 0.3, 4.0, 3.9), 0);   // R1 again
  add(test::box(0, 4.2, 3.5, 6), 0);       // a piece of C_1
  add(test::box(10.1, 0, 14, 3.8), 0);     // R4, not asked for
  add(test::box(0, 0, 4, 1.8), 1);         // less than half of U1
  add(test::box(20, 20, 24, 22), 0);       // nothing there
  const test::TempFolder folder;
  const std::string out = folder / "out", truth = folder / "truth";
  test::writeHouse(house, graph, test::kMapOfHouse, out, truth);
  const std::string output = outputOf("/usr/bin/python3 " + kScorer + " rooms " + truth + "/plan.json " +
                                      truth + "/gt.tum " + out + "/trajectory.tum " + out + "/graph.json");
  size_t asked = 0, found = 0;
  double recall = 0, precision = 0, iou = 0;
  ASSERT_EQ(std::sscanf(output.c_str(), "rooms asked %zu found %zu recall %lf precision %lf iou %lf", &asked,
                        &found, &recall, &precision, &iou),
            5)
      << output;
  const Evaluation ours = evaluate(out, readTruth(truth));
  EXPECT_EQ(ours.rooms.num_asked, asked);
  EXPECT_EQ(ours.rooms.num_found, found);
  EXPECT_EQ(found, 2u);
  EXPECT_NEAR(*shareOf(ours.rooms.num_true, ours.rooms.num_true + ours.rooms.num_false), precision, 1e-3);
  EXPECT_NEAR(ours.rooms.mean_iou, iou, 0.005);  // its raster has cells of 5 cm
  EXPECT_NE(output.find("false ['r2', 'r5', 'r6'] missed ['U1']"), std::string::npos) << output;
  for (const size_t j : {0, 1, 3, 4}) EXPECT_EQ(ours.rooms.estimates[j].why_false, "") << j;
  for (const size_t j : {2, 5, 6}) EXPECT_NE(ours.rooms.estimates[j].why_false, "") << j;
}

}  // namespace
}  // namespace sgraphs
