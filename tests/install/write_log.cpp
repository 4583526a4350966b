// write_log FILE: a log with scans 7 and 8 on ODOMETRY.
#include "common/bus/channels.h"
#include "common/bus/log_file.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  sgraphs::LogWriter log(argv[1]);
  for (const int scan : {7, 8}) {
    sgraphs::odometry_t message{};
    message.header.seq = scan - 7;
    message.scan = scan;
    sgraphs::write(log, 1000 * scan, sgraphs::channels::kOdometry, message);
  }
  log.close();
}
