// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to the learning rooms.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace engram::encoders {

/// The unsigned integer type with the size of T.
template <typename T>
using BitsOf =
    std::conditional_t<sizeof(T) == 1, uint8_t,
                       std::conditional_t<sizeof(T) == 2, uint16_t,
                                          std::conditional_t<sizeof(T) == 4, uint32_t, uint64_t>>>;

/// Writes numbers as little-endian bytes.
///
/// Threading: one thread.
class ByteWriter {
 public:
  template <typename T>
  void put(T value) {
    const auto bits = std::bit_cast<BitsOf<T>>(value);
    for (size_t i = 0; i < sizeof(T); ++i)
      bytes_.push_back(std::byte(static_cast<uint8_t>(bits >> (8 * i))));
  }

  /// Writes seven bits per byte, zigzag coded, so that small numbers of either sign are short.
  void put_varint(int64_t value) {
    auto code = (static_cast<uint64_t>(value) << 1) ^ static_cast<uint64_t>(value >> 63);
    for (; code >= 128; code >>= 7) put(static_cast<uint8_t>(code | 128));
    put(static_cast<uint8_t>(code));
  }

  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads the output of ByteWriter. Beyond the end it returns zeros, and failed() is true.
///
/// Threading: one thread.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename T>
  T get() {
    BitsOf<T> bits = 0;
    for (size_t i = 0; i < sizeof(T); ++i)
      bits = static_cast<BitsOf<T>>(bits | static_cast<BitsOf<T>>(BitsOf<T>{next()} << (8 * i)));
    return std::bit_cast<T>(bits);
  }

  int64_t get_varint() {
    uint64_t code = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const uint8_t byte = next();
      code |= uint64_t{byte & 127u} << shift;
      if (byte < 128) break;
    }
    return static_cast<int64_t>((code >> 1) ^ (0 - (code & 1)));
  }

  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] bool is_at_end() const { return at_ == bytes_.size(); }
  [[nodiscard]] std::span<const std::byte> rest() const { return bytes_.subspan(at_); }

 private:
  uint8_t next() {
    if (at_ < bytes_.size()) return std::to_integer<uint8_t>(bytes_[at_++]);
    failed_ = true;
    return 0;
  }

  std::span<const std::byte> bytes_;
  size_t at_ = 0;
  bool failed_ = false;
};

}  // namespace engram::encoders
