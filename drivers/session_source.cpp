#include "drivers/session_source.h"

#include <algorithm>
#include <sstream>

#include "drivers/recording/convert_recording.h"

namespace sgraphs {

Session liveSession(const SessionConfig& config, const std::string& writer, const std::string& config_digest,
                    Time start) {
  Session session;
  session.id = std::max<int64_t>(1, start.us);
  session.start = start;
  session.writer = writer;
  session.config_digest = config_digest;
  session.odometry_mode = config.odometry;
  session.has_odometry = session.odometry_mode != "lidar";
  session.T_body_lidar = parseTransform(config.T_body_lidar, "drivers.session.T_body_lidar");
  std::istringstream words(config.stages);
  for (std::string stage; words >> stage;) session.stages.push_back(stage);
  return session;
}

}  // namespace sgraphs
