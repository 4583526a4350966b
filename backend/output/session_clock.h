#pragma once

#include <span>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"

namespace sgraphs {

// One of the sessions that a map was made in. The map's clock goes on from session to session; a recording's
// own may lie before, beside or behind another's.
struct SessionClock {
  KeyframeId first;  // its first keyframe
  Time begin;        // of that, by the map's clock
  Duration shift;    // by which the map's clock is ahead of the recording's
};

// Which session a time of the map's clock belongs to, from 0; `clocks` in order of time.
inline size_t sessionAt(std::span<const SessionClock> clocks, Time map_time) {
  size_t session = 0;
  for (size_t i = 1; i < clocks.size(); ++i)
    if (clocks[i].begin <= map_time) session = i;
  return session;
}

// The same instant by the clock of its own recording.
inline Time recordedTime(std::span<const SessionClock> clocks, Time map_time) {
  return clocks.empty() ? map_time : map_time - clocks[sessionAt(clocks, map_time)].shift;
}

}  // namespace sgraphs
