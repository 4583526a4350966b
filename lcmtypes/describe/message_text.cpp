#include "lcmtypes/describe/message_text.h"

#include <bit>
#include <cctype>
#include <cinttypes>
#include <cstdio>
#include <map>

namespace sgraphs {
namespace {

using Member = TypeDescription::Member;

constexpr size_t kFingerprintBytes = 8;

// The bytes end too early, or counts in them cannot be right.
struct Malformed {};

// LCM's encoding: members one after the other, big-endian; strings with their length and a terminating zero.
class Walker {
 public:
  Walker(const TypeCatalogue& catalogue, std::span<const uint8_t> bytes, size_t max_elements)
      : catalogue_(catalogue), bytes_(bytes), max_elements_(max_elements) {}

  void walk(const TypeDescription& type, int level, std::string* out) {
    std::map<std::string, int64_t> counts;
    for (const Member& m : type.members) {
      if (out) *out += std::string(2 * static_cast<size_t>(level), ' ') + m.name;
      if (m.dimensions.empty()) {
        element(m, level, out, &counts[m.name]);
        continue;
      }
      std::vector<int64_t> sizes;
      for (const TypeDescription::Dimension& d : m.dimensions)
        sizes.push_back(d.member.empty() ? d.size : counts[d.member]);
      if (out)
        for (const int64_t size : sizes) *out += "[" + std::to_string(size) + "]";
      if (isPrimitive(m.type)) {
        if (out) *out += ": ";
        m.type == "byte" ? blob(sizes, out) : row(m, sizes, out);
        if (out) *out += "\n";
      } else {
        structs(m, sizes.front(), level, out);
      }
    }
  }
  bool atEnd() const { return at_ == bytes_.size(); }

 private:
  std::span<const uint8_t> take(size_t count) {
    if (count > bytes_.size() - at_) throw Malformed{};
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }
  uint64_t big(size_t count) {
    uint64_t value = 0;
    for (const uint8_t byte : take(count)) value = value << 8 | byte;
    return value;
  }
  // Every element takes a byte at least.
  size_t checked(int64_t count) const {
    if (count < 0 || static_cast<uint64_t>(count) > bytes_.size() - at_) throw Malformed{};
    return static_cast<size_t>(count);
  }

  // A single member: behind its name.
  void element(const Member& m, int level, std::string* out, int64_t* number) {
    if (isPrimitive(m.type)) {
      if (out) *out += ": ";
      primitive(m.type, out, number);
      if (out) *out += "\n";
    } else {
      if (out) *out += ":\n";
      walk(*catalogue_.find(m.type), level + 1, out);
    }
  }

  void structs(const Member& m, int64_t size, int level, std::string* out) {
    if (out) *out += size == 0 ? ": []\n" : ":\n";
    const size_t count = checked(size);
    for (size_t i = 0; i < count; ++i) {
      std::string* const shown = i < max_elements_ ? out : nullptr;
      const std::string indent(2 * static_cast<size_t>(level + 1), ' ');
      if (shown) *shown += indent + "[" + std::to_string(i) + "]:\n";
      if (out && i == max_elements_) *out += indent + "… " + std::to_string(count - i) + " more\n";
      walk(*catalogue_.find(m.type), level + 2, shown);
    }
  }

  // Primitive values in brackets, one pair for each dimension.
  void row(const Member& m, std::span<const int64_t> sizes, std::string* out) {
    const size_t count = checked(sizes.front());
    if (out) *out += "[";
    for (size_t i = 0; i < count; ++i) {
      std::string* const shown = i < max_elements_ ? out : nullptr;
      if (out && i > 0 && i <= max_elements_) *out += ", ";
      if (out && i == max_elements_) *out += "… " + std::to_string(count - i) + " more";
      if (sizes.size() > 1)
        row(m, sizes.subspan(1), shown);
      else
        primitive(m.type, shown, nullptr);
    }
    if (out) *out += "]";
  }

  void blob(std::span<const int64_t> sizes, std::string* out) {
    size_t count = 1;
    for (const int64_t size : sizes) count *= checked(size);
    const std::span<const uint8_t> bytes = take(count);
    if (!out) return;
    for (size_t i = 0; i < bytes.size() && i < max_elements_; ++i) {
      char text[4];
      std::snprintf(text, sizeof text, "%s%02x", i == 0 ? "" : " ", bytes[i]);
      *out += text;
    }
    if (bytes.size() > max_elements_)
      *out += " … " + std::to_string(bytes.size() - max_elements_) + " more bytes";
  }

  void primitive(const std::string& type, std::string* out, int64_t* number) {
    if (type == "string") {
      string(out);
    } else if (type == "float") {
      real(std::bit_cast<float>(static_cast<uint32_t>(big(4))), "%.7g", out);
    } else if (type == "double") {
      real(std::bit_cast<double>(big(8)), "%.12g", out);
    } else {
      const int64_t value = integer(type);
      if (number) *number = value;
      if (out) *out += std::to_string(value);
    }
  }

  int64_t integer(const std::string& type) {
    if (type == "byte") return static_cast<int64_t>(big(1));
    if (type == "int16_t") return static_cast<int16_t>(big(2));
    if (type == "int32_t") return static_cast<int32_t>(big(4));
    if (type == "int64_t") return static_cast<int64_t>(big(8));
    return static_cast<int8_t>(big(1));
  }

  static void real(double value, const char* format, std::string* out) {
    char text[40];
    if (out) out->append(text, static_cast<size_t>(std::snprintf(text, sizeof text, format, value)));
  }

  void string(std::string* out) {
    const size_t size = checked(static_cast<int32_t>(big(4)));
    const std::span<const uint8_t> text = take(size);
    if (size == 0 || text.back() != 0) throw Malformed{};
    if (!out) return;
    *out += '"';
    for (const uint8_t c : text.first(size - 1)) *out += c < 0x20 || c == 0x7F ? '?' : static_cast<char>(c);
    *out += '"';
  }

  const TypeCatalogue& catalogue_;
  std::span<const uint8_t> bytes_;
  size_t max_elements_;
  size_t at_ = kFingerprintBytes;
};

bool walkMessage(const TypeCatalogue& catalogue, std::span<const uint8_t> message, size_t max_elements,
                 std::string* out) {
  const TypeDescription* type = typeOf(catalogue, message);
  if (!type) return false;
  Walker walker(catalogue, message, max_elements);
  try {
    walker.walk(*type, 0, out);
  } catch (const Malformed&) {
    return false;
  }
  return walker.atEnd();
}

}  // namespace

const TypeDescription* typeOf(const TypeCatalogue& catalogue, std::span<const uint8_t> message) {
  if (message.size() < kFingerprintBytes) return nullptr;
  uint64_t fingerprint = 0;
  for (const uint8_t byte : message.first(kFingerprintBytes)) fingerprint = fingerprint << 8 | byte;
  return catalogue.findByFingerprint(static_cast<int64_t>(fingerprint));
}

std::optional<std::string> messageText(const TypeCatalogue& catalogue, std::span<const uint8_t> message,
                                       size_t max_elements) {
  std::string text;
  if (!walkMessage(catalogue, message, max_elements, &text)) return std::nullopt;
  return text;
}

bool isWholeMessage(const TypeCatalogue& catalogue, std::span<const uint8_t> message) {
  return walkMessage(catalogue, message, 0, nullptr);
}

}  // namespace sgraphs
