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

namespace engram::datasets::vault {

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
    if (count > bytes_.size()) {
      is_whole_ = false;
      bytes_ = {};
      return {};
    }
    const auto taken = bytes_.first(static_cast<size_t>(count));
    bytes_ = bytes_.subspan(static_cast<size_t>(count));
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
  [[nodiscard]] bool is_whole() const { return is_whole_; }
  [[nodiscard]] size_t rest() const { return bytes_.size(); }

 private:
  std::span<const std::byte> bytes_;
  bool is_whole_ = true;
};

}  // namespace engram::datasets::vault
