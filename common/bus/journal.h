#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.h"

namespace sgraphs {

// An append-only file of (name, bytes) records, from which a process that was killed resumes. It begins with
// 8 bytes "SGJRNL01"; a record is, in little-endian: CRC-32 of the rest of the record, length of the name (16
// bit), length of the bytes (32 bit), name, bytes. What is appended survives the death of the process at
// once, and that of the machine as far as its kernel has written it out.
struct JournalRecord {
  std::string name;
  std::vector<uint8_t> bytes;
};

// Reads a journal up to the first record that is not whole: cut short, or not what was written.
class JournalReader {
 public:
  // A journal that is not there has no records. Throws Error if the file cannot be read or does not begin as
  // a journal does.
  explicit JournalReader(const std::string& path);

  // The next record; nothing behind the last that is whole.
  std::optional<JournalRecord> next();
  int64_t goodBytes() const { return good_bytes_; }                // of the file, up to here
  int64_t bytesLeft() const { return file_bytes_ - good_bytes_; }  // behind them

 private:
  struct Closer {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::unique_ptr<std::FILE, Closer> file_;
  int64_t file_bytes_ = 0, good_bytes_ = 0;
};

class JournalWriter {
 public:
  // Appends to the file behind its first `good_bytes`; what follows them is cut off. 0: a new file. Throws
  // Error if it cannot be written.
  JournalWriter(const std::string& path, int64_t good_bytes);
  ~JournalWriter();
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  // Throws Error if the disk refuses it.
  void append(const std::string& name, Bus::Bytes bytes);
  // The file takes the place of another. Throws Error if it cannot.
  void moveTo(const std::string& path);
  int64_t bytes() const { return bytes_; }  // of the file

 private:
  std::string path_;
  int64_t bytes_ = 0;
  int file_ = -1;
};

// As in IEEE 802.3 and zlib.
uint32_t crc32(Bus::Bytes bytes);

}  // namespace sgraphs
