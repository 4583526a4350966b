#include <sqlite3.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "common/base/error.h"
#include "drivers/recording/ros/ros_bag.h"

namespace sgraphs {
namespace {

namespace fs = std::filesystem;

// "sensor_msgs/msg/PointCloud2" without the middle.
std::string ros1Type(const std::string& type) {
  const size_t at = type.find("/msg/");
  return at == std::string::npos ? type : type.substr(0, at) + type.substr(at + 4);
}

// One file of rosbag2's SQLite storage: tables topics(id, name, type, serialization_format) and
// messages(topic_id, timestamp, data).
class Db3File {
 public:
  explicit Db3File(const std::string& path) : path_(path) {
    if (const auto complaint = complaintAbout(path, RecordingKind::kSqlite)) throw Error(*complaint);
    sqlite3* database = nullptr;
    // A path with '?' or '#' would read as options of a URI: those are off.
    const int status = sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READONLY, nullptr);
    database_.reset(database);
    if (status != SQLITE_OK) fail();
    prepare("SELECT coalesce(min(timestamp), 0) FROM messages");
    step();
    first_ns_ = sqlite3_column_int64(statement_.get(), 0);
    readTopics();
  }

  const std::map<std::string, RosTopic>& topics() const { return topics_; }
  const std::string& path() const { return path_; }
  int64_t first_ns() const { return first_ns_; }

  void select(const std::string& topic) {
    prepare(
        "SELECT data FROM messages WHERE topic_id IN (SELECT id FROM topics WHERE name = ?) "
        "ORDER BY timestamp, id");
    if (sqlite3_bind_text(statement_.get(), 1, topic.c_str(), -1, SQLITE_TRANSIENT) != SQLITE_OK) fail();
  }

  // The next message, valid until the next call.
  std::optional<std::span<const uint8_t>> next() {
    if (!step()) return std::nullopt;
    const auto* bytes = static_cast<const uint8_t*>(sqlite3_column_blob(statement_.get(), 0));
    return std::span(bytes, static_cast<size_t>(sqlite3_column_bytes(statement_.get(), 0)));
  }

 private:
  struct Closer {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };

  [[noreturn]] void fail() const {
    throw Error("'" + path_ + "' is no whole bag of ROS 2 (" + sqlite3_errmsg(database_.get()) +
                "): if its recording was cut off, keep the -wal and -shm files beside it, or copy it again");
  }
  void prepare(const char* sql) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database_.get(), sql, -1, &statement, nullptr) != SQLITE_OK) fail();
    statement_.reset(statement);
  }
  bool step() {
    const int status = sqlite3_step(statement_.get());
    if (status != SQLITE_ROW && status != SQLITE_DONE) fail();
    return status == SQLITE_ROW;
  }
  std::string text(int column) const {
    const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
    return bytes ? bytes : "";
  }
  void readTopics() {
    prepare(
        "SELECT name, type, serialization_format, (SELECT count(*) FROM messages WHERE topic_id = topics.id) "
        "FROM topics");
    while (step()) {
      if (text(2) != "cdr")
        throw Error("bag '" + path_ + "' is serialised as '" + text(2) + "': only cdr is read");
      RosTopic& topic = topics_[text(0)];
      topic.name = text(0);
      topic.type = ros1Type(text(1));
      topic.count += sqlite3_column_int64(statement_.get(), 3);
    }
  }

  std::string path_;
  std::unique_ptr<sqlite3, Closer> database_;
  std::unique_ptr<sqlite3_stmt, Closer> statement_;  // goes before the database that it belongs to
  std::map<std::string, RosTopic> topics_;
  int64_t first_ns_ = 0;
};

std::vector<std::string> partsOf(const std::string& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<std::string> parts;
  std::string other;
  for (const auto& entry : fs::directory_iterator(path)) {
    if (entry.path().extension() == ".db3") parts.push_back(entry.path().string());
    if (entry.path().extension() == ".mcap" || entry.path().extension() == ".zstd")
      other = entry.path().string();
  }
  std::sort(parts.begin(), parts.end());
  if (!parts.empty()) return parts;
  // It will be refused for what it is.
  if (!other.empty()) return {other};
  throw Error("folder '" + path + "' holds no .db3 file: give the folder that `ros2 bag record` wrote");
}

class Ros2Bag : public RosBag {
 public:
  explicit Ros2Bag(const std::string& path) {
    for (const std::string& part : partsOf(path)) parts_.push_back(std::make_unique<Db3File>(part));
    // "_10" comes before "_2" by name.
    std::stable_sort(parts_.begin(), parts_.end(),
                     [](const auto& a, const auto& b) { return a->first_ns() < b->first_ns(); });
    std::map<std::string, RosTopic> by_name;
    for (const auto& part : parts_)
      for (const auto& [name, topic] : part->topics()) {
        const int64_t before = by_name[name].count;
        by_name[name] = topic;
        by_name[name].count += before;
      }
    for (const auto& [name, topic] : by_name) topics_.push_back(topic);
    if (topics_.empty()) throw Error("bag '" + path + "' holds no topic: record it again");
  }

  const std::vector<RosTopic>& topics() const override { return topics_; }
  std::vector<std::string> files() const override {
    std::vector<std::string> paths;
    for (const auto& part : parts_) paths.push_back(part->path());
    return paths;
  }
  void select(const std::string& topic) override {
    for (const auto& part : parts_) part->select(topic);
    at_ = 0;
  }
  std::optional<WireReader> next() override {
    for (; at_ < parts_.size(); ++at_)
      if (const auto bytes = parts_[at_]->next()) {
        constexpr uint8_t kZstd[] = {0x28, 0xB5, 0x2F, 0xFD};
        if (bytes->size() >= sizeof kZstd && std::equal(std::begin(kZstd), std::end(kZstd), bytes->begin()))
          throw Error(
              "the messages of '" + parts_[at_]->path() +
              "' are compressed with zstd, which is not read: write it anew with `ros2 bag convert`, " +
              "compression_mode none");
        return WireReader::cdr(*bytes);
      }
    return std::nullopt;
  }

 private:
  std::vector<std::unique_ptr<Db3File>> parts_;
  std::vector<RosTopic> topics_;
  size_t at_ = 0;
};

}  // namespace

std::unique_ptr<RosBag> openRos2Bag(const std::string& path) {
  return std::make_unique<Ros2Bag>(path);
}

}  // namespace sgraphs
