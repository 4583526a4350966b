#include "lcmtypes/describe/type_catalogue.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <stdexcept>

#include "lcmtypes/describe/lcm_texts.h"

namespace sgraphs {
namespace {

constexpr std::array<const char*, 9> kPrimitives{"int8_t", "int16_t", "int32_t", "int64_t", "float",
                                                 "double", "string",  "boolean", "byte"};

// Words and single signs; comments and blanks are gone.
std::vector<std::string> tokensOf(std::string_view text) {
  std::vector<std::string> tokens;
  const auto isWord = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.';
  };
  for (size_t at = 0; at < text.size();) {
    if (text.substr(at, 2) == "//") {
      at = std::min(text.find('\n', at), text.size());
    } else if (text.substr(at, 2) == "/*") {
      at = std::min(text.find("*/", at), text.size() - 2) + 2;
    } else if (std::isspace(static_cast<unsigned char>(text[at]))) {
      ++at;
    } else {
      const size_t begin = at++;
      if (isWord(text[begin]))
        while (at < text.size() && isWord(text[at])) ++at;
      tokens.emplace_back(text.substr(begin, at - begin));
    }
  }
  return tokens;
}

class Parser {
 public:
  explicit Parser(std::string_view text) : tokens_(tokensOf(text)) {}

  TypeDescription parse() {
    expect("package");
    next();
    expect(";");
    expect("struct");
    type_.name = next();
    expect("{");
    while (!accept("}")) {
      if (accept("const"))
        skipTo(";");
      else
        member();
    }
    return type_;
  }

 private:
  const std::string& next() {
    if (at_ == tokens_.size()) throw std::logic_error("an .lcm file ends too early");
    return tokens_[at_++];
  }
  bool accept(const std::string& token) {
    const bool found = at_ < tokens_.size() && tokens_[at_] == token;
    at_ += found;
    return found;
  }
  void expect(const std::string& token) {
    if (!accept(token))
      throw std::logic_error("an .lcm file of ours lacks '" + token + "' at '" + next() + "'");
  }
  void skipTo(const std::string& token) {
    while (next() != token) {
    }
  }
  void member() {
    TypeDescription::Member m;
    m.type = next();
    m.type.erase(0, m.type.rfind('.') + 1);
    m.name = next();
    while (accept("[")) {
      TypeDescription::Dimension d;
      d.text = next();
      if (std::isdigit(static_cast<unsigned char>(d.text.front())))
        d.size = std::stoll(d.text);
      else
        d.member = d.text;
      m.dimensions.push_back(d);
      expect("]");
    }
    expect(";");
    type_.members.push_back(m);
  }

  std::vector<std::string> tokens_;
  size_t at_ = 0;
  TypeDescription type_;
};

// LCM's hash over characters and strings; the shift to the right keeps the sign.
class Hash {
 public:
  void add(int value) {
    const auto spread = static_cast<uint64_t>(static_cast<int64_t>(value_) >> 55);
    value_ = ((value_ << 8) ^ spread) + static_cast<uint64_t>(static_cast<int64_t>(value));
  }
  void add(const std::string& text) {
    add(static_cast<int>(text.size()));
    for (const char c : text) add(static_cast<int>(c));
  }
  uint64_t value() const { return value_; }

 private:
  uint64_t value_ = 0x12345678;
};

}  // namespace

TypeDescription parseLcm(std::string_view text) {
  return Parser(text).parse();
}

bool isPrimitive(const std::string& type) {
  return std::find(kPrimitives.begin(), kPrimitives.end(), type) != kPrimitives.end();
}

const TypeCatalogue& TypeCatalogue::ours() {
  static const TypeCatalogue kOurs = [] {
    std::vector<TypeDescription> types;
    for (const std::string_view text : lcmTexts()) types.push_back(parseLcm(text));
    return TypeCatalogue(types);
  }();
  return kOurs;
}

TypeCatalogue::TypeCatalogue(const std::vector<TypeDescription>& types) {
  for (const TypeDescription& type : types) types_[type.name] = type;
  for (const auto& [name, type] : types_) {
    const auto fingerprint = static_cast<int64_t>(hashOf(type));
    fingerprints_[name] = fingerprint;
    names_[fingerprint] = name;
  }
}

uint64_t TypeCatalogue::hashOf(const TypeDescription& type) const {
  Hash hash;
  uint64_t inner = 0;
  for (const TypeDescription::Member& m : type.members) {
    hash.add(m.name);
    if (isPrimitive(m.type)) {
      hash.add(m.type);
    } else {
      const TypeDescription* part = find(m.type);
      if (!part) throw std::logic_error(type.name + "." + m.name + " is of unknown type " + m.type);
      inner += hashOf(*part);
    }
    hash.add(static_cast<int>(m.dimensions.size()));
    for (const TypeDescription::Dimension& d : m.dimensions) {
      hash.add(d.member.empty() ? 0 : 1);
      hash.add(d.text);
    }
  }
  return std::rotl(hash.value() + inner, 1);
}

const TypeDescription* TypeCatalogue::find(const std::string& name) const {
  const auto type = types_.find(name);
  return type == types_.end() ? nullptr : &type->second;
}

const TypeDescription* TypeCatalogue::findByFingerprint(int64_t fingerprint) const {
  const auto name = names_.find(fingerprint);
  return name == names_.end() ? nullptr : find(name->second);
}

}  // namespace sgraphs
