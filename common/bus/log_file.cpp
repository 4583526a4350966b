#include "common/bus/log_file.h"

#include <array>
#include <cerrno>
#include <cstring>

#include "common/base/error.h"

namespace sgraphs {
namespace {

constexpr std::array<uint8_t, 4> kSync{0xED, 0xA1, 0xDA, 0x01};
constexpr size_t kHeaderBytes = 24;                          // behind the sync word
constexpr int64_t kMaxChannel = 63;                          // LCM_MAX_CHANNEL_NAME_LENGTH
constexpr int64_t kMaxMessage = int64_t{256} * 1024 * 1024;  // LCM_MAX_MESSAGE_SIZE

int64_t readBig(const uint8_t* p, int bytes) {
  uint64_t v = 0;
  for (int i = 0; i < bytes; ++i) v = v << 8 | p[i];
  return static_cast<int64_t>(v);
}

void putBig(std::vector<uint8_t>& out, uint64_t v, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out.push_back(static_cast<uint8_t>(v >> (8 * i)));
}

}  // namespace

LogReader::LogReader(const std::string& path) : path_(path), file_(std::fopen(path.c_str(), "rb")) {
  if (!file_) throw Error("cannot read log '" + path + "': " + std::strerror(errno));
  std::fseek(file_.get(), 0, SEEK_END);
  file_bytes_ = std::ftell(file_.get());
  std::rewind(file_.get());
  if (file_bytes_ <= 0) throw Error("log '" + path + "' is empty: record or convert it again");
  std::array<uint8_t, 4> head{};
  if (std::fread(head.data(), 1, head.size(), file_.get()) != head.size() || head != kSync)
    throw Error("'" + path + "' is not an LCM log (no event at its beginning): pcap, raw and scan files go " +
                "through `sgraphs convert` first");
  std::rewind(file_.get());
}

bool LogReader::readSync() {
  uint32_t window = 0;
  for (int64_t read = 0;; ++read) {
    const int c = std::fgetc(file_.get());
    if (c == EOF) {
      // A sync word that the end cuts short is a truncated event; other bytes belong to none.
      skipped_bytes_ += read;
      truncated_ = read > 0;
      position_ = file_bytes_;
      return false;
    }
    window = window << 8 | static_cast<uint32_t>(c);
    if (read >= 3 && window == 0xEDA1DA01u) {
      skipped_bytes_ += read - 3;
      return true;
    }
  }
}

std::optional<LogEvent> LogReader::next() {
  while (readSync()) {
    const long after_sync = std::ftell(file_.get());
    std::array<uint8_t, kHeaderBytes> head{};
    if (std::fread(head.data(), 1, head.size(), file_.get()) != head.size()) {
      truncated_ = true;
      return std::nullopt;
    }
    LogEvent event;
    event.number = readBig(&head[0], 8);
    event.timestamp_us = readBig(&head[8], 8);
    const int64_t channel_bytes = readBig(&head[16], 4), data_bytes = readBig(&head[20], 4);
    if (channel_bytes <= 0 || channel_bytes > kMaxChannel || data_bytes > kMaxMessage) {
      // The sync word stood inside other bytes: go on behind it.
      std::fseek(file_.get(), after_sync, SEEK_SET);
      skipped_bytes_ += 4;
      continue;
    }
    if (after_sync + static_cast<int64_t>(kHeaderBytes) + channel_bytes + data_bytes > file_bytes_) {
      truncated_ = true;
      return std::nullopt;
    }
    event.channel.resize(static_cast<size_t>(channel_bytes));
    event.bytes.resize(static_cast<size_t>(data_bytes));
    if (std::fread(event.channel.data(), 1, event.channel.size(), file_.get()) != event.channel.size() ||
        std::fread(event.bytes.data(), 1, event.bytes.size(), file_.get()) != event.bytes.size())
      throw Error("cannot read log '" + path_ + "' at byte " + std::to_string(after_sync));
    position_ = std::ftell(file_.get());
    return event;
  }
  return std::nullopt;
}

LogWriter::LogWriter(const std::string& path) : path_(path), file_(std::fopen(path.c_str(), "wb")) {
  if (!file_) throw Error("cannot create log '" + path + "': " + std::strerror(errno));
}

LogWriter::~LogWriter() {
  if (file_) std::fclose(file_);
}

void LogWriter::write(int64_t timestamp_us, const std::string& channel, Bus::Bytes bytes) {
  std::vector<uint8_t> head(kSync.begin(), kSync.end());
  putBig(head, static_cast<uint64_t>(events_), 8);
  putBig(head, static_cast<uint64_t>(timestamp_us), 8);
  putBig(head, channel.size(), 4);
  putBig(head, bytes.size(), 4);
  head.insert(head.end(), channel.begin(), channel.end());
  if (std::fwrite(head.data(), 1, head.size(), file_) != head.size() ||
      std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size())
    throw Error("cannot write log '" + path_ + "': " + std::strerror(errno));
  ++events_;
}

void LogWriter::close() {
  std::FILE* file = file_;
  file_ = nullptr;
  if (file && std::fclose(file) != 0)
    throw Error("cannot write log '" + path_ + "': " + std::strerror(errno));
}

LogBus::LogBus(const std::string& input_path, LogWriter* output) : reader_(input_path), output_(output) {}

void LogBus::publish(const std::string& channel, Bytes bytes) {
  if (output_) output_->write(now_us_, channel, bytes);
}

void LogBus::subscribe(const std::string& channel, Handler handler) {
  handlers_.emplace_back(channel, std::move(handler));
}

bool LogBus::dispatch(int /*timeout_ms*/) {
  const std::optional<LogEvent> event = reader_.next();
  if (!event) return false;
  now_us_ = event->timestamp_us;
  for (const auto& [channel, handler] : handlers_)
    if (channel == event->channel) handler(event->bytes);
  return true;
}

}  // namespace sgraphs
