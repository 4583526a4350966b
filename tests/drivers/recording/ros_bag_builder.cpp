#include "tests/drivers/recording/ros_bag_builder.h"

#include <rosbag/bag.h>
#include <sqlite3.h>

#include <map>
#include <stdexcept>

using sgraphs::test::BagMessage;

// What rosbag wants to know of a type that it is to write.
namespace ros::message_traits {
template <>
struct IsMessage<BagMessage> : TrueType {};
template <>
struct MD5Sum<BagMessage> {
  static const char* value() { return "*"; }
  static const char* value(const BagMessage&) { return "0123456789abcdef0123456789abcdef"; }
};
template <>
struct DataType<BagMessage> {
  static const char* value() { return "*"; }
  static const char* value(const BagMessage& message) { return message.type.c_str(); }
};
template <>
struct Definition<BagMessage> {
  static const char* value(const BagMessage&) { return "# not looked at"; }
};
}  // namespace ros::message_traits

namespace ros::serialization {
template <>
struct Serializer<BagMessage> {
  template <typename Stream>
  static void write(Stream& stream, const BagMessage& message) {
    std::memcpy(stream.advance(serializedLength(message)), message.bytes.data(), message.bytes.size());
  }
  static uint32_t serializedLength(const BagMessage& message) {
    return static_cast<uint32_t>(message.bytes.size());
  }
};
}  // namespace ros::serialization

namespace sgraphs::test {

void writeRos1Bag(const std::string& path, const std::vector<BagMessage>& messages,
                  BagCompression compression) {
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  if (compression == BagCompression::kBz2) bag.setCompression(rosbag::compression::BZ2);
  if (compression == BagCompression::kLz4) bag.setCompression(rosbag::compression::LZ4);
  for (const BagMessage& message : messages)
    bag.write(message.topic,
              ros::Time(static_cast<uint32_t>(message.received_us / 1'000'000),
                        static_cast<uint32_t>(message.received_us % 1'000'000 * 1000)),
              message);
  bag.close();
}

namespace {

void check(bool ok, sqlite3* database) {
  if (!ok) throw std::runtime_error(sqlite3_errmsg(database));
}

void run(sqlite3* database, const std::string& sql) {
  check(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK, database);
}

std::string ros2Type(std::string type) {
  return type.insert(type.find('/'), "/msg");
}

}  // namespace

void writeDb3(const std::string& path, const std::vector<BagMessage>& messages) {
  sqlite3* database = nullptr;
  check(sqlite3_open(path.c_str(), &database) == SQLITE_OK, database);
  run(database,
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, "
      "data BLOB NOT NULL);"
      "CREATE INDEX timestamp_idx ON messages (timestamp ASC); BEGIN");
  std::map<std::string, int> ids;
  for (const BagMessage& message : messages) {
    const auto [topic, is_new] = ids.try_emplace(message.topic, static_cast<int>(ids.size()) + 1);
    if (is_new)
      run(database, "INSERT INTO topics VALUES (" + std::to_string(topic->second) + ", '" + message.topic +
                        "', '" + ros2Type(message.type) + "', 'cdr', '')");
    sqlite3_stmt* insert = nullptr;
    check(sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", -1,
                             &insert, nullptr) == SQLITE_OK,
          database);
    sqlite3_bind_int(insert, 1, topic->second);
    sqlite3_bind_int64(insert, 2, message.received_us * 1000);
    sqlite3_bind_blob(insert, 3, message.bytes.data(), static_cast<int>(message.bytes.size()),
                      SQLITE_TRANSIENT);
    check(sqlite3_step(insert) == SQLITE_DONE, database);
    sqlite3_finalize(insert);
  }
  run(database, "COMMIT");
  sqlite3_close(database);
}

}  // namespace sgraphs::test
