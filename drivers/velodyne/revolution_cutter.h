#pragma once

#include <cstdint>
#include <span>

namespace sgraphs {

// Tells which packet holds a revolution's cut: the first block whose azimuth has passed the cut angle.
class RevolutionCutter {
 public:
  // cut_azimuth_deg in the sensor's own azimuth, clockwise from its y axis, [0, 360).
  explicit RevolutionCutter(double cut_azimuth_deg = 0.0);

  // Index (0 to 11) of the first block of the packet that belongs to the next revolution; -1 if there is
  // none.
  int step(std::span<const uint8_t> packet);

  void visitState(auto& archive) { archive(has_previous_, previous_deg_); }

 private:
  double cut_azimuth_deg_;
  bool has_previous_ = false;
  double previous_deg_ = 0;  // azimuth past the cut of the previous valid block, [0, 360)
};

}  // namespace sgraphs
