#pragma once

#include <array>
#include <cstdint>

namespace sgraphs::simulate {

// What can be chosen about the simulated VLP-16.
struct SensorModel {
  double rpm = 600;
  double start_azimuth_deg = 0;  // of the first firing, clockwise from the sensor's x axis forward
  double range_sigma_m = 0.015;  // Gaussian, independent per return
  double min_range_m = 0.3;      // nearer surfaces give no return
  double max_range_m = 100.0;    // farther surfaces give no return
  double grazing_drop_deg =
      80.0;  // beyond this incidence returns are lost with growing probability; 90: none

  // Exact ranges to every surface in reach, for tests.
  static SensorModel noiseFree() {
    SensorModel model;
    model.range_sigma_m = 0;
    model.grazing_drop_deg = 90;
    return model;
  }
};

// Constants of the VLP-16 (its manual; ecosystem.md C).
namespace vlp16 {
inline constexpr int kLasers = 16;
inline constexpr int kBlocks = 12;
inline constexpr int kSequencesPerBlock = 2;
inline constexpr int kSequencesPerPacket = kBlocks * kSequencesPerBlock;
inline constexpr int kPacketBytes = 1206;
inline constexpr double kLaserPeriod_us = 2.304;
inline constexpr double kSequencePeriod_us = 55.296;
inline constexpr double kPacketPeriod_us = kSequencePeriod_us * kSequencesPerPacket;
inline constexpr double kRangeStep_m = 0.002;
inline constexpr std::array<double, kLasers> kElevation_deg{-15, 1, -13, 3,  -11, 5,  -9, 7,
                                                            -7,  9, -5,  11, -3,  13, -1, 15};
// Height of each laser's origin over the sensor's.
inline constexpr std::array<double, kLasers> kVerticalOffset_mm{11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1,
                                                                5.1,  -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2};
// Ring of a laser, counted from the lowest.
constexpr int ring(int laser) {
  return laser % 2 == 0 ? laser / 2 : 8 + laser / 2;
}
}  // namespace vlp16

}  // namespace sgraphs::simulate
