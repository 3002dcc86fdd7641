// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/range_bytes.h"

#include <utility>

namespace engram::encoders {

void RangeOutput::narrow(uint32_t start, uint32_t range) {
  low_ += start;
  range_ = range;
  while (range_ < kSmallestRange) {
    range_ <<= 8;
    shift_low();
  }
}

// A byte is written once no carry can reach it. 0xff bytes wait together with the byte before them.
void RangeOutput::shift_low() {
  if (low_ < 0xff000000u || low_ > 0xffffffffu) {
    const auto carry = static_cast<uint8_t>(low_ >> 32);
    if (has_pending_) bytes_.push_back(std::byte(static_cast<uint8_t>(pending_ + carry)));
    for (; pending_count_ > 0; --pending_count_)
      bytes_.push_back(std::byte(static_cast<uint8_t>(0xff + carry)));
    pending_ = static_cast<uint8_t>(low_ >> 24);
    has_pending_ = true;
  } else {
    ++pending_count_;
  }
  low_ = (low_ & 0x00ffffffu) << 8;
}

std::vector<std::byte> RangeOutput::finish() {
  // Any number in the last interval is valid, and the one with the most zeros at its end is the
  // shortest.
  const uint64_t last = low_ + range_ - 1;
  for (int bits = 32; bits >= 0; --bits) {
    const uint64_t rounded = (last >> bits) << bits;
    if (rounded < low_) continue;
    low_ = rounded;
    break;
  }
  for (int i = 0; i < 5; ++i) shift_low();
  while (!bytes_.empty() && bytes_.back() == std::byte{0}) bytes_.pop_back();
  return std::move(bytes_);
}

RangeInput::RangeInput(std::span<const std::byte> bytes) : bytes_(bytes) {
  for (int i = 0; i < 4; ++i) offset_ = (offset_ << 8) | next_byte();
}

uint32_t RangeInput::next_byte() {
  return at_ < bytes_.size() ? std::to_integer<uint32_t>(bytes_[at_++]) : 0;
}

void RangeInput::narrow(uint32_t start, uint32_t range) {
  offset_ -= start;
  range_ = range;
  while (range_ < kSmallestRange) {
    range_ <<= 8;
    offset_ = (offset_ << 8) | next_byte();
  }
}

}  // namespace engram::encoders
