#include <pcl/registration/ndt.h>

#include "tools/bench/baselines/pcl_points.h"
#include "tools/bench/baselines/scan_registration.h"

namespace sgraphs::bench {
namespace {

class Ndt final : public ScanRegistration {
 public:
  explicit Ndt(const NdtConfig& config) {
    ndt_.setResolution(static_cast<float>(config.resolution_m));
    ndt_.setTransformationEpsilon(config.epsilon);
    ndt_.setStepSize(config.step_m);
    ndt_.setMaximumIterations(config.max_iterations);
  }

  void setTarget(const Points& target) override { ndt_.setInputTarget(toPcl(target)); }

  ScanMatch align(const Points& source, const SE3& T_target_source_guess) override {
    PclCloud aligned;
    ndt_.setInputSource(toPcl(source));
    ndt_.align(aligned, toMatrix(T_target_source_guess));
    return {fromMatrix(ndt_.getFinalTransformation()), ndt_.hasConverged()};
  }

 private:
  pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> ndt_;
};

}  // namespace

std::unique_ptr<ScanRegistration> makeNdt(const NdtConfig& config) {
  return std::make_unique<Ndt>(config);
}

}  // namespace sgraphs::bench
