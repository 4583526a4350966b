#pragma once

namespace sgraphs::simulate {

// How the odometry of a walking robot's legs goes wrong. Drift grows with motion, not with time: standing
// feet do not slide. The signs of scale and biases are drawn from the seed.
struct LegsOdometryModel {
  double rate_hz = 50;
  double scale = 0.015;                     // error per distance walked
  double turn_scale = 0.01;                 // error per angle turned
  double yaw_bias_rad_per_m = 0.003;        // constant
  double yaw_walk_rad_per_sqrt_m = 0.003;   // random walk
  double slip_m_per_rad = 0.02;             // at turns, standard deviation per radian
  double height_bias_m_per_m = 0.001;       // constant
  double height_walk_m_per_sqrt_m = 0.003;  // random walk
  double tilt_sigma_rad = 0.0026;           // roll and pitch, by inertial sensors: 0.15 deg, correlated over
  double tilt_time_s = 10;                  // this time
  double white_position_m = 0.0005;         // independent per sample, not accumulated
  double white_rotation_rad = 0.0003;
  double clock_offset_s = 0;  // a sample of time t carries the stamp t + clock_offset_s
};

}  // namespace sgraphs::simulate
