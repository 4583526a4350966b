#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/performance.h"
#include "drivers/recording/pcap_reader.h"
#include "drivers/velodyne_live/datagram_source.h"

namespace sgraphs {

// A capture, played as if its datagrams arrived now.
class PcapPlayer : public DatagramSource {
 public:
  // rate: of playing, 1 as recorded, 0 as fast as they are taken. begin: moves the capture's clock so that
  // the first datagram arrives then; nothing: as captured. Intervals stay those captured at any rate. Throws
  // Error if the capture cannot be read or holds no datagram.
  PcapPlayer(const std::string& path, double rate, std::optional<Time> begin);

  std::vector<UdpDatagram> take(int timeout_ms) override;
  bool ended() const override { return !next_; }
  // Arrival of what was taken last.
  Time now() const override { return now_; }
  Health health() const override { return {}; }

 private:
  void advance();
  double dueIn_s() const;

  PcapReader reader_;
  double rate_;
  Duration shift_;
  std::optional<UdpDatagram> next_;  // its time is shifted
  Time first_, now_;
  Stopwatch watch_;
};

}  // namespace sgraphs
