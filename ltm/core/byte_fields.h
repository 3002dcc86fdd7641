// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "ltm/core/buffer.h"

namespace engram {

static_assert(std::endian::native == std::endian::little, "fields are written as they lie");

/// Appends fields to bytes: numbers little-endian, texts with their length before them.
template <typename Bytes>
class FieldWriter {
 public:
  explicit FieldWriter(Bytes& out) : out_(out) {}

  template <std::integral T>
  void number(T value) {
    bytes(std::as_bytes(std::span(&value, 1)));
  }

  void bytes(std::span<const std::byte> bytes) {
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }

  /// Needs a size below 4 GiB.
  void sized(std::span<const std::byte> content) {
    number(static_cast<uint32_t>(content.size()));
    bytes(content);
  }

  void text(std::string_view text) { sized(as_bytes(text)); }

 private:
  Bytes& out_;
};

/// Reads such fields of hostile bytes. What is missing is zero or empty, and is_whole() then says
/// no, so that one check after all reads replaces one for each.
class FieldReader {
 public:
  explicit FieldReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <std::integral T>
  T number() {
    T value{};
    const auto from = bytes(sizeof(T));
    if (!from.empty()) std::memcpy(&value, from.data(), sizeof(T));
    return value;
  }

  /// Views the next bytes; empty if there are fewer.
  std::span<const std::byte> bytes(uint64_t count) {
    if (count > rest()) {
      if (is_whole()) missing_ = count;
      return {};
    }
    const auto taken = bytes_.subspan(at_, static_cast<size_t>(count));
    at_ += taken.size();
    return taken;
  }

  std::span<const std::byte> sized() { return bytes(number<uint32_t>()); }
  std::string_view text() { return as_text(sized()); }

  /// Copies as many bytes as `out` has.
  void fill(std::span<std::byte> out) {
    const auto from = bytes(out.size());
    if (!from.empty()) std::memcpy(out.data(), from.data(), out.size());
  }

  /// False once more was read than there was.
  [[nodiscard]] bool is_whole() const { return missing_ == 0; }
  /// Bytes that were not read yet; none once something is missing.
  [[nodiscard]] size_t rest() const { return is_whole() ? bytes_.size() - at_ : 0; }

  /// Where the next field begins, or the one that is missing.
  [[nodiscard]] size_t at() const { return at_; }
  /// The size that the missing field needs; 0 if none is missing. Unit: bytes.
  [[nodiscard]] uint64_t missing() const { return missing_; }

 private:
  std::span<const std::byte> bytes_;
  size_t at_ = 0;
  uint64_t missing_ = 0;
};

}  // namespace engram
