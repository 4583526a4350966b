#pragma once

#include <string>
#include <vector>

#include "common/io/tum.h"
#include "tests/drivers/spot/fake_robot.h"

namespace sgraphs::test {

// A recorded walk, played once from `start` on in real time; before and after it the body stands at its ends.
class FakeTrajectory {
 public:
  // Throws Error for fewer than two poses.
  FakeTrajectory(std::vector<StampedPose> poses, Time start);

  FakeMotion at(Time host) const;
  Duration length() const { return poses_.back().time - poses_.front().time; }

 private:
  std::vector<StampedPose> poses_;
  Time start_;
};

// SPOT_ODOMETRY of a log. Throws Error if it holds none.
std::vector<StampedPose> readOdometryOfLog(const std::string& path);

}  // namespace sgraphs::test
