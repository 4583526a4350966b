#include "drivers/recording/message_header.h"

#include <cstring>
#include <string>

#include "common/bus/channels.h"
#include "lcmtypes/describe/type_catalogue.h"

namespace sgraphs {
namespace {

// An LCM message begins with the fingerprint of its type; our header is the first member behind it.
constexpr size_t kFingerprintBytes = 8;
constexpr size_t kSequenceOffset = kFingerprintBytes + 16;

int64_t readBig64(const uint8_t* p) {
  uint64_t value = 0;
  for (int i = 0; i < 8; ++i) value = value << 8 | p[i];
  return static_cast<int64_t>(value);
}

}  // namespace

bool hasTypeOf(const std::string& channel, Bus::Bytes bytes) {
  const channels::Row* row = channels::find(channel.c_str());
  return row && bytes.size() >= kFingerprintBytes &&
         readBig64(bytes.data()) == TypeCatalogue::ours().fingerprintOf(row->type);
}

bool hasTypeOf(const LogEvent& event) {
  return hasTypeOf(event.channel, event.bytes);
}

std::optional<header_t> readHeader(const std::string& channel, Bus::Bytes bytes) {
  const channels::Row* row = channels::find(channel.c_str());
  if (!hasTypeOf(channel, bytes) || std::string(row->type) == "pose_t") return std::nullopt;
  header_t header{};
  const auto size = static_cast<int>(bytes.size() - kFingerprintBytes);
  if (header._decodeNoHash(bytes.data(), kFingerprintBytes, size) < 0) return std::nullopt;
  return header;
}

std::optional<header_t> readHeader(const LogEvent& event) {
  return readHeader(event.channel, event.bytes);
}

void setSequence(LogEvent& event, int64_t seq) {
  for (size_t i = 0; i < 8; ++i)
    event.bytes[kSequenceOffset + i] = static_cast<uint8_t>(static_cast<uint64_t>(seq) >> (56 - 8 * i));
}

}  // namespace sgraphs
