#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/base/error.h"

namespace sgraphs {

// The state of an object as bytes, and back: a class lists its members once, in visitState(StateArchive&),
// for both ways. For checkpoints that the same program reads on the same machine: nothing is converted, and
// the bytes are no format for anybody else.
class StateArchive {
 public:
  // Writes.
  StateArchive() = default;
  // Reads; the bytes must outlive it.
  explicit StateArchive(std::span<const uint8_t> bytes) : left_(bytes), reading_(true) {}

  bool reading() const { return reading_; }
  bool atEnd() const { return left_.empty(); }
  std::vector<uint8_t> takeBytes() { return std::move(written_); }

  // Numbers, enumerations, plain structs, fixed matrices, quaternions, strings, vectors, deques, maps, pairs,
  // optionals of such, and classes with visitState. Throws Error where what is read cannot be what was
  // written.
  template <typename... Values>
  void operator()(Values&... values) {
    (visit(values), ...);
  }

 private:
  template <typename T>
  void visit(T& value) {
    if constexpr (requires { value.visitState(*this); })
      value.visitState(*this);
    else if constexpr (std::is_trivially_copyable_v<T>)
      raw(&value, sizeof value);
    else
      visitKnown(value);
  }

  template <typename Scalar, int Rows, int Cols>
  void visitKnown(Eigen::Matrix<Scalar, Rows, Cols>& value) {
    static_assert(Rows != Eigen::Dynamic && Cols != Eigen::Dynamic);
    raw(value.data(), sizeof(Scalar) * static_cast<size_t>(Rows * Cols));
  }
  void visitKnown(Eigen::Quaterniond& value) { visitKnown(value.coeffs()); }
  void visitKnown(std::string& value) {
    value.resize(count(value.size(), 1));
    raw(value.data(), value.size());
  }
  template <typename T>
  void visitKnown(std::vector<T>& values) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      values.resize(count(values.size(), sizeof(T)));
      raw(values.data(), values.size() * sizeof(T));
    } else {
      values.resize(count(values.size(), 1));
      for (T& value : values) visit(value);
    }
  }
  template <typename T>
  void visitKnown(std::deque<T>& values) {
    const size_t n = count(values.size(), 1);
    while (values.size() > n) values.pop_back();
    while (values.size() < n) values.emplace_back();
    for (T& value : values) visit(value);
  }
  template <typename Key, typename T>
  void visitKnown(std::map<Key, T>& values) {
    const size_t n = count(values.size(), 1);
    if (!reading_) {
      for (auto& [key, value] : values) {
        Key copy = key;
        visit(copy);
        visit(value);
      }
      return;
    }
    values.clear();
    for (size_t i = 0; i < n; ++i) {
      Key key{};
      visit(key);
      visit(values[key]);
    }
  }
  template <typename A, typename B>
  void visitKnown(std::pair<A, B>& value) {
    visit(value.first);
    visit(value.second);
  }
  template <typename T>
  void visitKnown(std::optional<T>& value) {
    bool there = value.has_value();
    visit(there);
    if (!there) return value.reset();
    if (!value) value.emplace();
    visit(*value);
  }

  // A number of elements of so many bytes at least: more than there can be are not made room for.
  size_t count(size_t written, size_t least_bytes) {
    uint64_t n = written;
    raw(&n, sizeof n);
    if (reading_ && n > left_.size() / least_bytes) refuse();
    return static_cast<size_t>(n);
  }
  void raw(void* value, size_t size) {
    if (!reading_) {
      const auto* begin = static_cast<const uint8_t*>(value);
      written_.insert(written_.end(), begin, begin + size);
      return;
    }
    if (size > left_.size()) refuse();
    if (size > 0) std::memcpy(value, left_.data(), size);
    left_ = left_.subspan(size);
  }
  [[noreturn]] static void refuse() { throw Error("a checkpoint ends before what it should hold"); }

  std::vector<uint8_t> written_;
  std::span<const uint8_t> left_;
  bool reading_ = false;
};

}  // namespace sgraphs
