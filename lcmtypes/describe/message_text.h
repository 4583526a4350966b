#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "lcmtypes/describe/type_catalogue.h"

namespace sgraphs {

// Type of a message by its first eight bytes; nullptr: not of the catalogue.
const TypeDescription* typeOf(const TypeCatalogue& catalogue, std::span<const uint8_t> message);

// A message of any type of the catalogue as lines "member: value", indented by two blanks per level. Of an
// array the first max_elements elements are shown. Nothing if the bytes are not exactly one message.
std::optional<std::string> messageText(const TypeCatalogue& catalogue, std::span<const uint8_t> message,
                                       size_t max_elements);

// The bytes are exactly one message of a type of the catalogue.
bool isWholeMessage(const TypeCatalogue& catalogue, std::span<const uint8_t> message);

}  // namespace sgraphs
