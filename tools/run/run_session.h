#pragma once

#include <map>
#include <string>

#include "common/bus/publisher.h"
#include "common/types/session.h"
#include "sgraphs/header_t.hpp"
#include "sgraphs/session_t.hpp"
#include "tools/run/process_table.h"

namespace sgraphs {

// What SESSION of this run says: all stages, and that rounds are recorded by ROUND_SCHEDULE. A log that is
// played keeps its identity and its mount. `now`: the host's clock. Throws Error if the log holds no SESSION,
// UsageError for a mount that is none.
Session sessionOf(const RunOptions& options, Time now);

// The source's side of a run: SESSION first and at 1 Hz, STREAM_END last. The sources themselves are told to
// be silent about both.
class RunSession {
 public:
  // The bus must outlive this.
  RunSession(Bus& bus, Session session);

  const Session& session() const { return session_; }
  void publishSession(Time now);
  // A message of a raw channel came by.
  void heard(const std::string& channel, const header_t& header);
  // STREAM_END with the last numbers of what came by; once more (same number) if called again.
  void publishEnd(const std::string& why_not);

 private:
  Bus& bus_;
  Session session_;
  Publisher publisher_;
  std::map<std::string, int64_t> last_seq_;
  Time newest_;
  std::optional<stream_end_t> end_;
};

}  // namespace sgraphs
