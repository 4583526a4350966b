#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backend/output/run_outputs.h"
#include "common/bus/log_file.h"
#include "common/bus/memory_bus.h"
#include "tools/system/bus_worker.h"
#include "tools/system/stages.h"
#include "tools/system/system_config.h"

namespace sgraphs {

struct ReplayProgress {
  double share = 0;     // of the log's bytes, 0 to 1
  double sensor_s = 0;  // sensor time so far
  double wall_s = 0;
};

struct ReplayOptions {
  std::string log;
  SystemConfig config;
  std::string odometry;                  // "lidar", "encoder", "fused"; empty: as SESSION says
  std::vector<std::string> stages = {};  // that take part, in place of SESSION's; empty: as SESSION says
  std::function<void(const ReplayProgress&)> on_progress = {};  // after each event; may be empty
  std::string record = {};  // log that every channel is written to, raw and derived; empty: none
};

// All stages in one process, fed from a log in file order through its raw channels alone. The nodes are those
// of the processes, over encoded bytes, so that the result is theirs to the last bit. With more than one
// thread the odometry, which needs nothing from the others, runs ahead of them.
class Replay {
 public:
  // Throws Error if the log cannot be read or holds no SESSION of this version.
  explicit Replay(ReplayOptions options);

  // Works through the log. Throws Error if it holds no scan that can be used.
  void run();

  // What the run leaves behind; valid after run(), as long as this object lives.
  RunRecord record() const;
  // What a reader should know of the log: truncated, no STREAM_END, … One line each.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  void inspect();
  void startRecording();
  void connect();
  bool obeysSchedule(const session_t& session) const;
  void feed(const LogEvent& event);
  void feedSession(session_t session);
  void endWithoutStreamEnd();
  void requireScans() const;

  ReplayOptions options_;
  std::shared_ptr<Vlp16Counts> counts_ = std::make_shared<Vlp16Counts>();
  MemoryBus odometry_bus_, bus_;  // the odometry's, and that of all others
  std::optional<OdometryNode> odometry_;
  std::optional<PlanesNode> planes_;
  std::optional<FreeSpaceNode> free_space_;
  std::optional<RoomsNode> rooms_;
  std::optional<LoopsNode> loops_;
  std::optional<BackendNode> backend_;
  std::optional<BusWorker> others_;
  std::unique_ptr<LogWriter> recording_;
  int64_t now_us_ = 0;  // receive time of the event that is being worked on
  std::vector<std::string> warnings_;
  std::string input_digest_;
  double wall_s_ = 0;
};

}  // namespace sgraphs
