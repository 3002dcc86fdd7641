// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace engram::encoders {

/// Below this a range is widened by a byte.
inline constexpr uint32_t kSmallestRange = 1u << 24;

/// Turns an interval that gets smaller and smaller into bytes: what every range encoder shares.
///
/// Threading: one thread.
class RangeOutput {
 public:
  [[nodiscard]] uint32_t range() const { return range_; }

  /// Goes on with the part of the interval from `start` on, `range` wide. Both lie within range().
  void narrow(uint32_t start, uint32_t range);

  /// Ends the stream; zero bytes at its end are left out. Must not be used afterwards.
  [[nodiscard]] std::vector<std::byte> finish();

 private:
  void shift_low();

  uint64_t low_ = 0;
  uint32_t range_ = 0xffffffff;
  uint8_t pending_ = 0;
  uint64_t pending_count_ = 0;
  bool has_pending_ = false;
  std::vector<std::byte> bytes_;
};

/// Follows the interval that RangeOutput wrote. Behind the last byte come zeros.
///
/// Threading: one thread.
class RangeInput {
 public:
  /// `bytes` outlive it.
  explicit RangeInput(std::span<const std::byte> bytes);

  [[nodiscard]] uint32_t range() const { return range_; }

  /// How far into the interval the written number lies.
  [[nodiscard]] uint32_t offset() const { return offset_; }

  /// As RangeOutput::narrow.
  void narrow(uint32_t start, uint32_t range);

 private:
  [[nodiscard]] uint32_t next_byte();

  std::span<const std::byte> bytes_;
  size_t at_ = 0;
  uint32_t offset_ = 0;
  uint32_t range_ = 0xffffffff;
};

}  // namespace engram::encoders
