#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "common/base/time.h"
#include "common/bus/log_file.h"

namespace sgraphs {

// OUT/map.lcmlog: what a map was made of. The whole graph is a function of what the stages before it said:
// SESSION, ROUND_SCHEDULE (of a live run), KEYFRAME, KEYFRAME_PLANES and ODOMETRY, as they were said on the
// bus, and ODOMETRY_END at the end of each session. Whoever hears them again has the map again, with
// everything that belongs to it. The log's own time of an event is the recording's clock; stamps in the
// messages are the map's, which goes on from session to session.
inline constexpr const char* kMapLogName = "map.lcmlog";

// Writes it, under a name of its own until the run is complete: so a run may continue the map of the folder
// that it writes to, and a run that fails leaves it as it was.
class MapLogWriter {
 public:
  // Creates the folder if need be. Throws Error if the file cannot be written.
  explicit MapLogWriter(const std::string& out_dir);
  ~MapLogWriter();
  MapLogWriter(const MapLogWriter&) = delete;
  MapLogWriter& operator=(const MapLogWriter&) = delete;

  // Listens to the bus of the map's stages; it must not outlive this.
  void listenTo(Bus& bus);
  // What the present session's stamps are ahead of its own clock.
  void setShift(std::function<Duration()> shift) { shift_ = std::move(shift); }
  void write(const std::string& channel, Bus::Bytes bytes);
  // The file is complete.
  void commit();

 private:
  std::string path_, part_;
  std::unique_ptr<LogWriter> log_;
  std::function<Duration()> shift_;
  bool session_written_ = false;
};

// What an earlier run left in its folder.
class EarlierMap {
 public:
  // Throws Error if the folder is no complete result, if its map cannot be read or is of another version's
  // messages; one line each that says what to do.
  explicit EarlierMap(const std::string& dir);

  const std::string& dir() const { return dir_; }
  // As its summary.json has them.
  const std::string& graphDigest() const { return graph_digest_; }
  const std::string& configDigest() const { return config_digest_; }
  const std::string& version() const { return version_; }

  // Calls the handler with each event in order; `share` of the file, 0 to 1. Throws Error if the file is
  // damaged.
  void read(const std::function<void(const LogEvent&, double share)>& handler) const;

 private:
  std::string dir_, path_;
  std::string graph_digest_, config_digest_, version_;
};

}  // namespace sgraphs
