#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>

namespace sgraphs {

// The bytes are not a message of the type they were read as.
class WireError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// How a ROS message is written: ROS 1 packs its members little-endian one after the other; ROS 2 writes CDR
// (OMG formal/02-06-51, 15.3), where members are aligned to their size and the first four bytes tell the
// order of bytes.
class WireReader {
 public:
  static WireReader ros1(std::span<const uint8_t> bytes) { return {bytes, false, false}; }
  // Throws WireError for another encapsulation than plain CDR.
  static WireReader cdr(std::span<const uint8_t> bytes);

  bool isCdr() const { return cdr_; }

  template <typename T>
  requires std::integral<T> || std::floating_point<T> T read() {
    align(sizeof(T));
    const std::span<const uint8_t> bytes = readBytes(sizeof(T));
    T value;
    if (!swap_) {
      std::memcpy(&value, bytes.data(), sizeof(T));
    } else {
      uint8_t turned[sizeof(T)];
      for (size_t i = 0; i < sizeof(T); ++i) turned[i] = bytes[sizeof(T) - 1 - i];
      std::memcpy(&value, turned, sizeof(T));
    }
    return value;
  }
  std::string readString();
  // Number of elements of a sequence, of which each takes at least that many bytes.
  size_t readCount(size_t least_bytes);
  // Throws WireError if there are fewer left.
  std::span<const uint8_t> readBytes(size_t count);

 private:
  static_assert(std::endian::native == std::endian::little);
  WireReader(std::span<const uint8_t> bytes, bool cdr, bool swap) : bytes_(bytes), cdr_(cdr), swap_(swap) {}
  void align(size_t size);

  std::span<const uint8_t> bytes_;  // of CDR: behind the encapsulation header, which alignment counts from
  size_t at_ = 0;
  bool cdr_, swap_;
};

}  // namespace sgraphs
