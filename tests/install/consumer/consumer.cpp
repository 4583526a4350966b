#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <string>

#include "sgraphs/odometry_t.hpp"

// consumer LOG: prints the scan number of each message on ODOMETRY.
int main(int argc, char** argv) {
  if (argc != 2) return 2;
  lcm::LogFile log(argv[1], "r");
  if (!log.good()) return 1;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    sgraphs::odometry_t message;
    if (event->channel != "ODOMETRY" || message.decode(event->data, 0, event->datalen) < 0) continue;
    std::printf("scan %lld\n", static_cast<long long>(message.scan));
  }
}
