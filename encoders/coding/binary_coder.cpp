// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/binary_coder.h"

#include <algorithm>

namespace engram::encoders {

bool BinaryEncoder::code(bool bit, BitProbability one) {
  const uint32_t bound = (output_.range() >> kProbabilityBits) * one;
  output_.narrow(bit ? 0 : bound, bit ? bound : output_.range() - bound);
  return bit;
}

uint32_t BinaryEncoder::code_even(uint32_t value, int count) {
  const uint32_t part = output_.range() >> count;
  output_.narrow(value * part, part);
  return value;
}

std::vector<std::byte> BinaryEncoder::finish() {
  return output_.finish();
}

bool BinaryDecoder::code(bool, BitProbability one) {
  const uint32_t bound = (input_.range() >> kProbabilityBits) * one;
  const bool bit = input_.offset() < bound;
  input_.narrow(bit ? 0 : bound, bit ? bound : input_.range() - bound);
  return bit;
}

uint32_t BinaryDecoder::code_even(uint32_t, int count) {
  const uint32_t part = input_.range() >> count;
  // Encoders never write the remainder after the last part, so an offset there is clamped.
  const uint32_t value = std::min(input_.offset() / part, (1u << count) - 1);
  input_.narrow(value * part, part);
  return value;
}

}  // namespace engram::encoders
