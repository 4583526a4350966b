#include "tools/eval/eval_plots.h"

#include <gtest/gtest.h>

#include "tests/tools/eval/truth_fixture.h"

namespace sgraphs {
namespace {

TEST(SliceMeshTest, WallAppearsAsItsOutline) {
  const TriangleMesh wall = test::rectangle({1, 2, 0}, {0, 4, 0}, {0, 0, 2});
  double length = 0;
  for (const auto& [a, b] : sliceMesh(wall, 1.0)) {
    EXPECT_DOUBLE_EQ(a.x(), 1);
    EXPECT_DOUBLE_EQ(b.x(), 1);
    length += (a - b).norm();
  }
  EXPECT_NEAR(length, 4, 1e-12);
  EXPECT_TRUE(sliceMesh(wall, 3.0).empty());
}

}  // namespace
}  // namespace sgraphs
