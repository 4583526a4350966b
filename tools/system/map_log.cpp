#include "tools/system/map_log.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "common/bus/channels.h"
#include "common/io/text_file.h"
#include "lcmtypes/convert/convert.h"

namespace sgraphs {
namespace {

constexpr const char* kChannels[] = {channels::kSession.name,  channels::kRoundSchedule.name,
                                     channels::kKeyframe.name, channels::kKeyframePlanes.name,
                                     channels::kOdometry.name, channels::kOdometryEnd.name};

// Every message of these begins with the same header: fingerprint, then session, boot, seq, utime. Decoding
// all of it for the stamp alone would cost more than the rest of the writing.
int64_t stampOf(Bus::Bytes bytes) {
  constexpr size_t kStamp = 8 + 3 * 8;
  if (bytes.size() < kStamp + 8) return 0;
  uint64_t value = 0;
  for (size_t i = 0; i < 8; ++i) value = value << 8U | bytes[kStamp + i];
  return static_cast<int64_t>(value);
}

}  // namespace

MapLogWriter::MapLogWriter(const std::string& out_dir)
    : path_(out_dir + "/" + kMapLogName), part_(path_ + ".part") {
  createFolder(out_dir);
  log_ = std::make_unique<LogWriter>(part_);
}

MapLogWriter::~MapLogWriter() {
  if (!log_) return;
  log_.reset();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void MapLogWriter::listenTo(Bus& bus) {
  for (const char* channel : kChannels)
    bus.subscribe(channel, [this, channel](Bus::Bytes bytes) { write(channel, bytes); });
}

void MapLogWriter::write(const std::string& channel, Bus::Bytes bytes) {
  if (!log_) return;
  if (channel == channels::kSession.name && std::exchange(session_written_, true)) return;
  log_->write(stampOf(bytes) - (shift_ ? shift_().us : 0), channel, bytes);
}

void MapLogWriter::commit() {
  log_->close();
  log_.reset();
  std::error_code error;
  std::filesystem::rename(part_, path_, error);
  if (error) throw Error("cannot write '" + path_ + "': " + error.message());
}

EarlierMap::EarlierMap(const std::string& dir) : dir_(dir), path_(dir + "/" + kMapLogName) {
  namespace fs = std::filesystem;
  if (!fs::is_directory(dir))
    throw Error("map '" + dir + "' is no folder: give the output folder of an earlier `sgraphs replay`");
  const std::string summary_path = dir + "/summary.json";
  if (!fs::exists(summary_path))
    throw Error("map '" + dir + "' holds no summary.json: it is no complete result of `sgraphs replay`");
  if (!fs::exists(path_))
    throw Error("map '" + dir + "' holds no " + kMapLogName +
                ": replay its recording with this version, then continue that result");
  try {
    const auto summary = nlohmann::json::parse(readFile(summary_path));
    graph_digest_ = summary.at("graph_digest");
    config_digest_ = summary.at("config_digest");
    version_ = summary.at("version");
  } catch (const nlohmann::json::exception& e) {
    throw Error("cannot read '" + summary_path + "': " + e.what() + "; replay its recording again");
  }
  LogReader reader(path_);
  const std::optional<LogEvent> first = reader.next();
  session_t session{};
  if (!first || first->channel != channels::kSession.name || !decode(first->bytes, session))
    throw Error("map '" + path_ +
                "' does not begin with a SESSION of this program's messages: it is damaged, "
                "or of another version; replay its recording again");
  if (session.schema != kMessageSchema)
    throw Error("map '" + path_ + "' was written with message schema " + std::to_string(session.schema) +
                ", this version reads schema " + std::to_string(kMessageSchema) +
                ": replay its recording again");
}

void EarlierMap::read(const std::function<void(const LogEvent&, double share)>& handler) const {
  const std::string again = ": it is damaged; replay its recording again";
  LogReader reader(path_);
  std::string last;
  while (const std::optional<LogEvent> event = reader.next()) {
    if (reader.skippedBytes() > 0) break;
    handler(*event, static_cast<double>(reader.position()) / static_cast<double>(reader.fileBytes()));
    last = event->channel;
  }
  if (reader.skippedBytes() > 0)
    throw Error("map '" + path_ + "' holds bytes that belong to no event" + again);
  if (reader.truncated()) throw Error("map '" + path_ + "' ends in the middle of an event" + again);
  if (last != channels::kOdometryEnd.name)
    throw Error("map '" + path_ + "' ends before its session does" + again);
}

}  // namespace sgraphs
