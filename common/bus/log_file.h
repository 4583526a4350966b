#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.h"

namespace sgraphs {

// One event of an LCM log.
struct LogEvent {
  int64_t number = 0;
  int64_t timestamp_us = 0;  // receive time; never used by an algorithm
  std::string channel;
  std::vector<uint8_t> bytes;
};

// Reads an LCM log (28-byte big-endian event headers behind the sync word 0xEDA1DA01, ecosystem.md A6) with
// what LCM's own reader lacks: a truncated tail and foreign bytes are told, not skipped in silence.
class LogReader {
 public:
  // Throws Error if the file cannot be read, is empty, or does not begin with an LCM event.
  explicit LogReader(const std::string& path);

  // Next event; nothing at the end. Bytes that belong to no event are skipped up to the next sync word.
  std::optional<LogEvent> next();

  int64_t skippedBytes() const { return skipped_bytes_; }
  bool truncated() const { return truncated_; }  // the file ends in the middle of an event
  int64_t fileBytes() const { return file_bytes_; }
  int64_t position() const { return position_; }

 private:
  struct Closer {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  bool readSync();

  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
  int64_t file_bytes_ = 0;
  int64_t position_ = 0;
  int64_t skipped_bytes_ = 0;
  bool truncated_ = false;
};

// Writes an LCM log that lcm-logplayer reads.
class LogWriter {
 public:
  // Throws Error if the file cannot be created.
  explicit LogWriter(const std::string& path);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  void write(int64_t timestamp_us, const std::string& channel, Bus::Bytes bytes);
  // Flushes and closes; throws Error if the disk refused anything. The destructor closes without a word.
  void close();

  int64_t events() const { return events_; }

 private:
  std::string path_;
  std::FILE* file_ = nullptr;
  int64_t events_ = 0;
};

template <typename Message>
void write(LogWriter& log, int64_t timestamp_us, const Channel<Message>& channel, const Message& message) {
  log.write(timestamp_us, channel.name, encoded(message));
}

// A log as a bus: dispatch() delivers one event; publish() appends to a second log, if one is given.
class LogBus : public Bus {
 public:
  explicit LogBus(const std::string& input_path, LogWriter* output = nullptr);
  void publish(const std::string& channel, Bytes bytes) override;
  void subscribe(const std::string& channel, Handler handler) override;
  // Delivers the next event; false at the end of the log.
  bool dispatch(int timeout_ms) override;
  const LogReader& reader() const { return reader_; }

 private:
  LogReader reader_;
  LogWriter* output_;
  int64_t now_us_ = 0;
  std::vector<std::pair<std::string, Handler>> handlers_;
};

}  // namespace sgraphs
