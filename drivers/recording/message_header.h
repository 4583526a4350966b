#pragma once

#include <optional>
#include <string>

#include "common/bus/log_file.h"
#include "sgraphs/header_t.hpp"

namespace sgraphs {

// The event is on one of our channels, and its bytes are of that channel's type in this version.
bool hasTypeOf(const std::string& channel, Bus::Bytes bytes);
bool hasTypeOf(const LogEvent& event);

// Header of a message on one of our channels; nothing for pose_t, which has none, and for bytes of another
// type.
std::optional<header_t> readHeader(const std::string& channel, Bus::Bytes bytes);
std::optional<header_t> readHeader(const LogEvent& event);

// Puts another sequence number into a message that has a header.
void setSequence(LogEvent& event, int64_t seq);

}  // namespace sgraphs
