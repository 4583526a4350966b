#pragma once

#include <vector>

namespace sgraphs::simulate {

// What goes wrong between sensor and log. Shares are probabilities per data packet, independent of each
// other.
struct FaultModel {
  double packet_loss = 0;
  double packet_duplicates = 0;
  double packet_reorders = 0;    // changes places with the packet after it
  double packet_corruption = 0;  // some of its bytes are noise

  struct Silence {
    double begin_s = 0;  // since the start
    double duration_s = 0;
  };
  std::vector<Silence> silences;  // no packets

  struct ClockJump {
    double at_s = 0;  // since the start
    double by_s = 0;  // added to the sensor's own stamps from then on; the host's clock does not jump
  };
  std::vector<ClockJump> clock_jumps;

  bool none() const {
    return packet_loss == 0 && packet_duplicates == 0 && packet_reorders == 0 && packet_corruption == 0 &&
           silences.empty() && clock_jumps.empty();
  }
};

}  // namespace sgraphs::simulate
