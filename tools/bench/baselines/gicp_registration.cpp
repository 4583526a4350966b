#include <pcl/registration/gicp.h>
#include <pcl/search/kdtree.h>

#include <limits>

#include "tools/bench/baselines/pcl_points.h"
#include "tools/bench/baselines/scan_registration.h"

namespace sgraphs::bench {
namespace {

class Gicp final : public ScanRegistration {
 public:
  explicit Gicp(const GicpConfig& config) {
    gicp_.setMaxCorrespondenceDistance(config.max_correspondence_m);
    gicp_.setTransformationEpsilon(config.epsilon);
    gicp_.setMaximumIterations(config.max_iterations);
    gicp_.setCorrespondenceRandomness(config.neighbours);
  }

  void setTarget(const Points& target) override { gicp_.setInputTarget(toPcl(target)); }

  ScanMatch align(const Points& source, const SE3& T_target_source_guess) override {
    PclCloud aligned;
    gicp_.setInputSource(toPcl(source));
    gicp_.align(aligned, toMatrix(T_target_source_guess));
    return {fromMatrix(gicp_.getFinalTransformation()), gicp_.hasConverged()};
  }

 private:
  pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> gicp_;
};

}  // namespace

std::unique_ptr<ScanRegistration> makeGicp(const GicpConfig& config) {
  return std::make_unique<Gicp>(config);
}

double fitness_m2(const Points& target, const Points& source, const SE3& T_target_source,
                  double max_range_m) {
  if (target.empty()) return std::numeric_limits<double>::infinity();
  pcl::search::KdTree<pcl::PointXYZ> tree(false);
  tree.setInputCloud(toPcl(target));
  std::vector<int> index(1);
  std::vector<float> squared_m2(1);
  double sum = 0;
  size_t count = 0;
  for (const Eigen::Vector3f& p : source) {
    const Eigen::Vector3f q = (T_target_source * p.cast<double>()).cast<float>();
    if (tree.nearestKSearch({q.x(), q.y(), q.z()}, 1, index, squared_m2) == 0) continue;
    if (squared_m2[0] > max_range_m * max_range_m) continue;
    sum += squared_m2[0];
    ++count;
  }
  return count ? sum / static_cast<double>(count) : std::numeric_limits<double>::infinity();
}

}  // namespace sgraphs::bench
