#include "common/bus/journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "common/base/error.h"

namespace sgraphs {
namespace {

constexpr char kMagic[] = "SGJRNL01";
constexpr size_t kMagicBytes = sizeof kMagic - 1;
constexpr size_t kHeadBytes = 4 + 2 + 4;
// Longer than any message or checkpoint of ours; a length beyond it is no length.
constexpr uint32_t kMaxBytes = 256u << 20;

void put(std::vector<uint8_t>& out, uint32_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

uint32_t get(const uint8_t* in, int bytes) {
  uint32_t value = 0;
  for (int i = 0; i < bytes; ++i) value |= static_cast<uint32_t>(in[i]) << (8 * i);
  return value;
}

constexpr std::array<uint32_t, 256> crcTable() {
  std::array<uint32_t, 256> table{};
  for (uint32_t i = 0; i < 256; ++i) {
    uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1u) ? 0xEDB88320u : 0u);
    table[i] = value;
  }
  return table;
}

}  // namespace

uint32_t crc32(Bus::Bytes bytes) {
  static constexpr std::array<uint32_t, 256> kTable = crcTable();
  uint32_t crc = 0xFFFFFFFFu;
  for (const uint8_t byte : bytes) crc = (crc >> 8) ^ kTable[(crc ^ byte) & 0xFFu];
  return ~crc;
}

JournalReader::JournalReader(const std::string& path) {
  std::error_code none;
  const auto size = std::filesystem::file_size(path, none);
  if (none || size == 0) return;
  file_.reset(std::fopen(path.c_str(), "rb"));
  if (!file_) throw Error("cannot read journal '" + path + "': " + std::strerror(errno));
  char magic[kMagicBytes] = {};
  if (std::fread(magic, 1, kMagicBytes, file_.get()) != kMagicBytes ||
      std::memcmp(magic, kMagic, kMagicBytes) != 0)
    throw Error("'" + path + "' is no journal of this version: remove it");
  file_bytes_ = static_cast<int64_t>(size);
  good_bytes_ = kMagicBytes;
}

std::optional<JournalRecord> JournalReader::next() {
  uint8_t head[kHeadBytes];
  if (!file_ || std::fread(head, 1, kHeadBytes, file_.get()) != kHeadBytes) return std::nullopt;
  const uint32_t name_length = get(head + 4, 2), length = get(head + 6, 4);
  if (length > kMaxBytes) return std::nullopt;
  std::vector<uint8_t> checked(head + 4, head + kHeadBytes);
  checked.resize(kHeadBytes - 4 + name_length + length);
  const uint8_t* body = checked.data() + kHeadBytes - 4;
  if (std::fread(checked.data() + kHeadBytes - 4, 1, name_length + length, file_.get()) !=
          name_length + length ||
      get(head, 4) != crc32(checked))
    return std::nullopt;
  good_bytes_ += static_cast<int64_t>(4 + checked.size());
  return JournalRecord{{body, body + name_length}, {body + name_length, body + name_length + length}};
}

JournalWriter::JournalWriter(const std::string& path, int64_t good_bytes) : path_(path), bytes_(good_bytes) {
  file_ = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file_ < 0 || ftruncate(file_, good_bytes) != 0 ||
      (good_bytes == 0 && ::write(file_, kMagic, kMagicBytes) != static_cast<ssize_t>(kMagicBytes)))
    throw Error("cannot write journal '" + path + "': " + std::strerror(errno));
}

JournalWriter::~JournalWriter() {
  close(file_);
}

void JournalWriter::append(const std::string& name, Bus::Bytes bytes) {
  std::vector<uint8_t> record;
  record.reserve(kHeadBytes + name.size() + bytes.size());
  put(record, 0, 4);
  put(record, static_cast<uint32_t>(name.size()), 2);
  put(record, static_cast<uint32_t>(bytes.size()), 4);
  record.insert(record.end(), name.begin(), name.end());
  record.insert(record.end(), bytes.begin(), bytes.end());
  const uint32_t crc = crc32(Bus::Bytes(record).subspan(4));
  for (int i = 0; i < 4; ++i) record[static_cast<size_t>(i)] = static_cast<uint8_t>(crc >> (8 * i));
  if (::write(file_, record.data(), record.size()) != static_cast<ssize_t>(record.size()))
    throw Error("cannot write journal '" + path_ + "': " + std::strerror(errno) + "; make room on the disk");
  bytes_ += static_cast<int64_t>(record.size());
}

void JournalWriter::moveTo(const std::string& path) {
  if (std::rename(path_.c_str(), path.c_str()) != 0)
    throw Error("cannot write journal '" + path + "': " + std::strerror(errno));
  path_ = path;
}

}  // namespace sgraphs
