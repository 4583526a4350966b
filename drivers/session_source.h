#pragma once

#include <string>

#include "common/types/session.h"
#include "drivers/driver_config.h"

namespace sgraphs {

// The session of a live run that begins at `start`. Its id is drawn from that instant, never 0. Throws
// UsageError for a mount that is none.
Session liveSession(const SessionConfig& config, const std::string& writer, const std::string& config_digest,
                    Time start);

}  // namespace sgraphs
