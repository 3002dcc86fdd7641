// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/binary_coder.h"

namespace engram::encoders {

bool BinaryEncoder::code(bool bit, BitProbability one) {
  const uint32_t bound = (output_.range() >> kProbabilityBits) * one;
  output_.narrow(bit ? 0 : bound, bit ? bound : output_.range() - bound);
  return bit;
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

}  // namespace engram::encoders
