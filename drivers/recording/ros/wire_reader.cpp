#include "drivers/recording/ros/wire_reader.h"

namespace sgraphs {

WireReader WireReader::cdr(std::span<const uint8_t> bytes) {
  constexpr size_t kEncapsulationBytes = 4;
  if (bytes.size() < kEncapsulationBytes) throw WireError("no CDR header");
  // 0: big-endian, 1: little-endian; parameter lists and the second version of XCDR have other numbers.
  if (bytes[0] != 0 || bytes[1] > 1)
    throw WireError("CDR encapsulation " + std::to_string(bytes[0] << 8 | bytes[1]) + " is not known");
  return {bytes.subspan(kEncapsulationBytes), true, bytes[1] == 0};
}

void WireReader::align(size_t size) {
  if (!cdr_) return;
  const size_t padding = (size - at_ % size) % size;
  readBytes(padding);
}

std::span<const uint8_t> WireReader::readBytes(size_t count) {
  if (count > bytes_.size() - at_) throw WireError("it ends too early");
  at_ += count;
  return bytes_.subspan(at_ - count, count);
}

std::string WireReader::readString() {
  const std::span<const uint8_t> bytes = readBytes(read<uint32_t>());
  std::string text(bytes.begin(), bytes.end());
  // CDR counts the terminating zero.
  if (cdr_ && !text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

size_t WireReader::readCount(size_t least_bytes) {
  const size_t count = read<uint32_t>();
  if (count * least_bytes > bytes_.size() - at_) throw WireError("a sequence is longer than the message");
  return count;
}

}  // namespace sgraphs
