#include "tools/simulate/scene/read_scene.h"

namespace sgraphs::simulate {

void readSensor(const PlanReader& in, SensorModel& sensor) {
  in.allowOnly(
      {"rpm", "start_azimuth_deg", "range_sigma_m", "min_range_m", "max_range_m", "grazing_drop_deg"});
  sensor.rpm = in.number("rpm", sensor.rpm, 300, 1200);
  sensor.start_azimuth_deg = in.number("start_azimuth_deg", sensor.start_azimuth_deg, 0, 360);
  sensor.range_sigma_m = in.number("range_sigma_m", sensor.range_sigma_m, 0, 1);
  sensor.min_range_m = in.number("min_range_m", sensor.min_range_m, 0, 10);
  sensor.max_range_m = in.number("max_range_m", sensor.max_range_m, 1, 130);
  sensor.grazing_drop_deg = in.number("grazing_drop_deg", sensor.grazing_drop_deg, 0, 90);
}

void readLegs(const PlanReader& in, LegsOdometryModel& legs) {
  in.allowOnly({"rate_hz", "scale", "turn_scale", "yaw_bias_rad_per_m", "yaw_walk_rad_per_sqrt_m",
                "slip_m_per_rad", "height_bias_m_per_m", "height_walk_m_per_sqrt_m", "tilt_sigma_rad",
                "tilt_time_s", "white_position_m", "white_rotation_rad", "clock_offset_s"});
  legs.rate_hz = in.number("rate_hz", legs.rate_hz, 1, 1000);
  legs.scale = in.number("scale", legs.scale, 0, 0.5);
  legs.turn_scale = in.number("turn_scale", legs.turn_scale, 0, 0.5);
  legs.yaw_bias_rad_per_m = in.number("yaw_bias_rad_per_m", legs.yaw_bias_rad_per_m, 0, 1);
  legs.yaw_walk_rad_per_sqrt_m = in.number("yaw_walk_rad_per_sqrt_m", legs.yaw_walk_rad_per_sqrt_m, 0, 1);
  legs.slip_m_per_rad = in.number("slip_m_per_rad", legs.slip_m_per_rad, 0, 1);
  legs.height_bias_m_per_m = in.number("height_bias_m_per_m", legs.height_bias_m_per_m, 0, 1);
  legs.height_walk_m_per_sqrt_m = in.number("height_walk_m_per_sqrt_m", legs.height_walk_m_per_sqrt_m, 0, 1);
  legs.tilt_sigma_rad = in.number("tilt_sigma_rad", legs.tilt_sigma_rad, 0, 0.5);
  legs.tilt_time_s = in.number("tilt_time_s", legs.tilt_time_s, 0.01, 1e6);
  legs.white_position_m = in.number("white_position_m", legs.white_position_m, 0, 1);
  legs.white_rotation_rad = in.number("white_rotation_rad", legs.white_rotation_rad, 0, 1);
  legs.clock_offset_s = in.number("clock_offset_s", legs.clock_offset_s, -3600, 3600);
}

void readFaults(const PlanReader& in, FaultModel& faults) {
  in.allowOnly({"packet_loss", "packet_duplicates", "packet_reorders", "packet_corruption", "silences",
                "clock_jumps"});
  faults.packet_loss = in.number("packet_loss", faults.packet_loss, 0, 1);
  faults.packet_duplicates = in.number("packet_duplicates", faults.packet_duplicates, 0, 1);
  faults.packet_reorders = in.number("packet_reorders", faults.packet_reorders, 0, 1);
  faults.packet_corruption = in.number("packet_corruption", faults.packet_corruption, 0, 1);
  in.forEach("silences", [&](const PlanReader& silence) {
    silence.allowOnly({"begin_s", "duration_s"});
    faults.silences.push_back(
        {silence.number("begin_s", 0, 0, 1e6), silence.number("duration_s", 0, 0, 1e6)});
    if (!silence.has("begin_s") || !silence.has("duration_s"))
      silence.fail("", "needs begin_s and duration_s");
  });
  in.forEach("clock_jumps", [&](const PlanReader& jump) {
    jump.allowOnly({"at_s", "by_s"});
    faults.clock_jumps.push_back({jump.number("at_s", 0, 0, 1e6), jump.number("by_s", 0, -1e6, 1e6)});
    if (!jump.has("at_s") || !jump.has("by_s")) jump.fail("", "needs at_s and by_s");
  });
}

}  // namespace sgraphs::simulate
