#pragma once

#include <string>

#include "common/config/config_io.h"

namespace sgraphs {

// Settings of sgraphs-spot-bridge; user and password are no settings (see credentials.h).
struct SpotBridgeConfig {
  std::string host;
  int port = 443;
  std::string root_cert;
  std::string credentials;
  std::string frame = "odom";
  double poll_hz = 50;
  double call_timeout_s = 0.5;
  double time_sync_interval_s = 60;
  double max_slew_ppm = 1000;
  double max_stamp_error_s = 0.25;
  double token_renewal_s = 3600;
  double reconnect_first_s = 0.5;
  double reconnect_max_s = 10;

  void visit(ConfigVisitor& v) {
    v.field("host", host, {}, "Name or address of the robot; empty: must be given as --host");
    v.field("port", port, 1, 65535, "TCP port of the robot's services");
    v.field("root_cert", root_cert, {}, "PEM file of the certificate that signed the robot's");
    v.field("credentials", credentials, {},
            "File with SGRAPHS_SPOT_USER=… and SGRAPHS_SPOT_PASSWORD=…, readable by its owner only; empty: "
            "from the "
            "environment");
    v.field("frame", frame, {"odom", "vision"},
            "Frame of the odometry: odom (legs only, smooth) or vision (with cameras, may jump)");
    v.field("poll_hz", poll_hz, 1, 50, "Robot states asked for per second");
    v.field("call_timeout_s", call_timeout_s, 0.05, 10, "Deadline of every call");
    v.field("time_sync_interval_s", time_sync_interval_s, 1, 600, "Time between looks at the robot's clock");
    v.field("max_slew_ppm", max_slew_ppm, 10, 100000,
            "Stamps follow a new clock offset by at most this [microseconds per second]");
    v.field("max_stamp_error_s", max_stamp_error_s, 0.05, 10,
            "A state acquired further than this outside its call means that a clock jumped");
    v.field("token_renewal_s", token_renewal_s, 1, 36000, "Age at which the robot's token is renewed");
    v.field("reconnect_first_s", reconnect_first_s, 0.05, 60, "Pause before the first try to connect again");
    v.field("reconnect_max_s", reconnect_max_s, 0.05, 600,
            "Longest of these pauses; each is twice the one before");
  }
};

}  // namespace sgraphs
