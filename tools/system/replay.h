#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backend/output/run_outputs.h"
#include "common/bus/log_file.h"
#include "common/bus/memory_bus.h"
#include "perception/relocalise/relocalise_node.h"
#include "tools/system/bus_worker.h"
#include "tools/system/map_log.h"
#include "tools/system/stages.h"
#include "tools/system/system_config.h"

namespace sgraphs {

struct ReplayProgress {
  bool loading = false;  // of the earlier map; else of the log
  double share = 0;      // of the log's bytes, 0 to 1
  double sensor_s = 0;   // sensor time so far
  double wall_s = 0;
};

struct ReplayOptions {
  std::string log;
  SystemConfig config;
  std::string odometry;                  // "lidar", "encoder", "fused"; empty: as SESSION says
  std::vector<std::string> stages = {};  // that take part, in place of SESSION's; empty: as SESSION says
  std::function<void(const ReplayProgress&)> on_progress = {};  // after each event; may be empty
  std::string record = {};   // log that every channel is written to, raw and derived; empty: none
  std::string map = {};      // folder of an earlier run whose map is continued; empty: a map of its own
  std::string out_dir = {};  // folder that gets map.lcmlog; empty: none
};

// All stages in one process, fed from a log in file order through its raw channels alone. The nodes are those
// of the processes, over encoded bytes, so that the result is theirs to the last bit. With more than one
// thread the odometry, which needs nothing from the others, runs ahead of them.
//
// The session's odometry and planes speak on a bus of their own; the stages that make the map listen to
// another. Where an earlier map is continued, the latter has heard all that made that map, and a
// RelocaliseNode stands between the two until the robot is found.
class Replay {
 public:
  // Loads the earlier map, if one is to be continued. Throws Error if it or the log cannot be read, or the
  // log holds no SESSION of this version.
  explicit Replay(ReplayOptions options);

  // Works through the log. Throws Error if it holds no scan that can be used, or if the robot was not found
  // in the earlier map.
  void run();

  // What the run leaves behind; valid after run(), as long as this object lives.
  RunRecord record() const;
  // What a reader should know of the log: truncated, no STREAM_END, … One line each.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  void inspect();
  void startRecording();
  void connect();
  void feedBeginning();
  void loadMap();
  template <typename Message>
  void sessionBegins(const Message& m, const LogEvent& event);
  void publishOnMap(const std::string& channel, Bus::Bytes bytes);
  void restAfter(const LogEvent& end);
  MapEnd mapEnd() const;
  void connectRelocaliser();
  void requireFound() const;
  RunRecord::Continued continued() const;
  bool obeysSchedule(const session_t& session) const;
  void feed(const LogEvent& event);
  session_t withStages(session_t session) const;
  void endWithoutStreamEnd();
  void requireScans() const;

  ReplayOptions options_;
  std::shared_ptr<Vlp16Counts> counts_ = std::make_shared<Vlp16Counts>();
  MemoryBus odometry_bus_;  // raw channels, and what the odometry says
  MemoryBus session_bus_;   // the same behind the odometry's thread, and what the planes say
  MemoryBus bus_;           // of the map
  std::optional<OdometryNode> odometry_;
  std::optional<PlanesNode> planes_;
  std::optional<FreeSpaceNode> free_space_;
  std::optional<RoomsNode> rooms_;
  std::optional<LoopsNode> loops_;
  std::optional<BackendNode> backend_;
  std::optional<BusWorker> others_;
  std::optional<EarlierMap> earlier_;
  std::shared_ptr<Relocaliser> relocaliser_;
  std::optional<RelocaliseNode> relocalise_;
  std::unique_ptr<MapLogWriter> map_log_;
  // Of the earlier map, as it was loaded.
  struct Loaded {
    int64_t session = 0;
    odometry_t last{};  // its newest
    bool between_sessions = true;
    std::vector<SessionClock> sessions;
    Duration shift;
    int64_t keyframes = 0;
    std::string graph_digest;
    double wall_s = 0;
  } loaded_;
  session_t session_{};  // as it is recorded
  std::vector<LogEvent> schedules_;
  std::unique_ptr<LogWriter> recording_;
  int64_t now_us_ = 0;  // receive time of the event that is being worked on
  std::vector<std::string> warnings_;
  std::string input_digest_;
  double wall_s_ = 0;
};

}  // namespace sgraphs
