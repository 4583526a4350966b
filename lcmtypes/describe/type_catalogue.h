#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace sgraphs {

// A struct of an .lcm file.
struct TypeDescription {
  struct Dimension {
    int64_t size = 0;    // of a fixed dimension
    std::string member;  // that holds the size of a variable one; empty: fixed
    std::string text;    // as it is written
  };
  struct Member {
    std::string type;  // without package
    std::string name;
    std::vector<Dimension> dimensions;  // none: a single value
  };
  std::string name;
  std::vector<Member> members;
};

// One struct (package, struct, members, constants, comments). Throws std::logic_error saying what is not
// understood.
TypeDescription parseLcm(std::string_view text);

// int8_t to int64_t, float, double, string, boolean, byte.
bool isPrimitive(const std::string& type);

// Types by name and by the fingerprint with which LCM begins a message. The fingerprint is computed from the
// description as lcm-gen does: over names, primitive types and dimensions of the members, and the
// fingerprints of the types within; a test compares.
class TypeCatalogue {
 public:
  // The types of lcmtypes/, as they were when this program was built.
  static const TypeCatalogue& ours();

  // Throws std::logic_error if a member's type is not among them.
  explicit TypeCatalogue(const std::vector<TypeDescription>& types);

  // nullptr: not ours.
  const TypeDescription* find(const std::string& name) const;
  const TypeDescription* findByFingerprint(int64_t fingerprint) const;
  // Throws std::out_of_range for a name that is not ours.
  int64_t fingerprintOf(const std::string& name) const { return fingerprints_.at(name); }

 private:
  uint64_t hashOf(const TypeDescription& type) const;

  std::map<std::string, TypeDescription> types_;
  std::map<std::string, int64_t> fingerprints_;
  std::map<int64_t, std::string> names_;
};

}  // namespace sgraphs
