#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace sgraphs {

// SHA-256 over a canonical byte stream: integers little-endian, doubles as their IEEE bits, strings with
// their length.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void addBytes(std::span<const uint8_t> bytes);
  void add(int64_t value);
  void add(double value);
  void add(std::string_view text);
  template <typename Derived>
  void add(const Eigen::DenseBase<Derived>& values) {
    for (Eigen::Index r = 0; r < values.rows(); ++r)
      for (Eigen::Index c = 0; c < values.cols(); ++c) add(static_cast<double>(values(r, c)));
  }

  // Hexadecimal digest of all that was added; the object must not be used afterwards.
  std::string hex();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

// Digest of a file's bytes. Throws Error if it cannot be read.
std::string sha256OfFile(const std::string& path);

}  // namespace sgraphs
