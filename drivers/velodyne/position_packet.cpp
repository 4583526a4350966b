#include "drivers/velodyne/position_packet.h"

#include <charconv>
#include <chrono>
#include <string_view>
#include <vector>

namespace sgraphs {
namespace {

constexpr size_t kStampAt = 198, kPpsAt = 202, kSentenceAt = 206;

// Whole number of two digits at `at`; -1 if there is none.
int twoDigits(std::string_view text, size_t at) {
  int value = -1;
  if (at + 2 > text.size()) return -1;
  const char* end = text.data() + at + 2;
  const auto result = std::from_chars(text.data() + at, end, value);
  return result.ptr == end ? value : -1;
}

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  for (size_t comma = text.find(','); comma != std::string_view::npos; comma = text.find(',')) {
    parts.push_back(text.substr(0, comma));
    text.remove_prefix(comma + 1);
  }
  parts.push_back(text);
  return parts;
}

// The text between '$' and '*' if the checksum behind it is right; else nothing.
std::string_view checkedBody(std::string_view sentence) {
  const size_t star = sentence.rfind('*');
  if (star == std::string_view::npos || star + 3 > sentence.size()) return {};
  int told = -1;
  std::from_chars(sentence.data() + star + 1, sentence.data() + star + 3, told, 16);
  const std::string_view body = sentence.substr(1, star - 1);
  int sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  return told == sum ? body : std::string_view{};
}

// hhmmss and ddmmyy.
std::optional<Time> utcOf(std::string_view time, std::string_view date) {
  using namespace std::chrono;
  const int h = twoDigits(time, 0), m = twoDigits(time, 2), s = twoDigits(time, 4);
  const int d = twoDigits(date, 0), mon = twoDigits(date, 2), y = twoDigits(date, 4);
  if (h < 0 || h > 23 || m < 0 || m > 59 || s < 0 || s > 60 || d < 0 || mon < 0 || y < 0) return std::nullopt;
  const year_month_day day{year{2000 + y}, month{static_cast<unsigned>(mon)},
                           std::chrono::day{static_cast<unsigned>(d)}};
  if (!day.ok()) return std::nullopt;
  const auto instant = sys_days{day} + hours{h} + minutes{m} + seconds{s};
  return Time{duration_cast<microseconds>(instant.time_since_epoch()).count()};
}

}  // namespace

const char* toString(PpsState state) {
  switch (state) {
    case PpsState::kAbsent:
      return "no pulse";
    case PpsState::kSynchronising:
      return "synchronising";
    case PpsState::kLocked:
      return "locked";
    case PpsState::kError:
      return "error";
  }
  return "unknown";
}

std::optional<PositionPacket> parsePositionPacket(std::span<const uint8_t> bytes) {
  if (bytes.size() != kPositionPacketBytes || bytes[kPpsAt] > 3) return std::nullopt;
  PositionPacket packet;
  for (size_t i = 0; i < 4; ++i) packet.stamp_us |= static_cast<uint32_t>(bytes[kStampAt + i]) << (8 * i);
  packet.pps = static_cast<PpsState>(bytes[kPpsAt]);
  for (size_t at = kSentenceAt; at < bytes.size() && bytes[at] >= ' ' && bytes[at] < 127; ++at)
    packet.sentence += static_cast<char>(bytes[at]);
  if (!packet.sentence.starts_with("$GPRMC,")) {
    packet.sentence.clear();
    return packet;
  }
  const std::vector<std::string_view> fields = split(checkedBody(packet.sentence));
  if (fields.size() < 10) return packet;
  packet.fix = fields[2] == "A";
  packet.utc = utcOf(fields[1], fields[9]);
  return packet;
}

}  // namespace sgraphs
