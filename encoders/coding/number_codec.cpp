// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/number_codec.h"

#include "encoders/coding/checked_block.h"
#include "encoders/coding/number_row_coder.h"
#include "ltm/core/check.h"

namespace engram::encoders {

namespace {

constexpr size_t kMaxReserved = 1 << 20;

}  // namespace

std::vector<std::byte> NumberCodec::encode(std::span<const double> rows) const {
  const size_t numbers = model_.count();
  ENGRAM_CHECK(numbers > 0 ? rows.size() % numbers == 0 : rows.empty(), "{} numbers in rows of {}",
               rows.size(), numbers);
  BinaryEncoder encoder;
  NumberRowCoder coder(model_);
  std::vector<double> row(numbers);
  for (size_t at = 0; at < rows.size(); at += numbers) {
    std::ranges::copy(rows.subspan(at, numbers), row.begin());
    coder.code(encoder, row);
  }
  return with_checksum(encoder.finish(), numbers == 0 ? 0 : rows.size() / numbers);
}

Result<std::vector<double>> NumberCodec::decode(std::span<const std::byte> block,
                                                size_t count) const {
  ENGRAM_ASSIGN_OR_RETURN(const auto body, without_checksum(block, "block of numbers", count));
  BinaryDecoder decoder(body);
  NumberRowCoder coder(model_);
  std::vector<double> rows, row(model_.count());
  rows.reserve(std::min(count * row.size(), kMaxReserved));
  for (size_t i = 0; i < count; ++i) {
    coder.code(decoder, row);
    rows.insert(rows.end(), row.begin(), row.end());
  }
  return rows;
}

}  // namespace engram::encoders
