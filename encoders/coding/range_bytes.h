// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace engram::encoders {

/// A smaller range is widened by a byte.
inline constexpr uint32_t kSmallestRange = 1u << 24;

/// The output of a range encoder: writes a shrinking interval as bytes.
///
/// Threading: one thread.
class RangeOutput {
 public:
  [[nodiscard]] uint32_t range() const { return range_; }

  /// Narrows the interval to `range` values from `start` on. Both must lie within range().
  void narrow(uint32_t start, uint32_t range);

  /// Ends the stream, without the zero bytes at its end. The object must not be used afterwards.
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

/// The input of a range decoder: follows the interval that RangeOutput wrote. Zeros follow the last
/// byte.
///
/// Threading: one thread.
class RangeInput {
 public:
  /// `bytes` must outlive this object.
  explicit RangeInput(std::span<const std::byte> bytes);

  [[nodiscard]] uint32_t range() const { return range_; }

  /// Offset of the written number in the interval.
  [[nodiscard]] uint32_t offset() const { return offset_; }

  /// See RangeOutput::narrow.
  void narrow(uint32_t start, uint32_t range);

 private:
  [[nodiscard]] uint32_t next_byte();

  std::span<const std::byte> bytes_;
  size_t at_ = 0;
  uint32_t offset_ = 0;
  uint32_t range_ = 0xffffffff;
};

}  // namespace engram::encoders
