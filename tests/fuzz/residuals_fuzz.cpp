// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "encoders/coding/residual_image.h"
#include "ltm/core/buffer.h"
#include "tests/fuzz/fuzz_check.h"

namespace engram::encoders {
namespace {

constexpr size_t kRows = 4;

constexpr std::array<PixelShape, 4> kShapes{{{8, 8, 1}, {24, 16, 3}, {11, 21, 3}, {9, 7, 4}}};

void check_rows(std::span<const std::byte> bytes, const PixelShape& shape) {
  const auto sizes = residual_bytes(bytes, kRows);
  const auto rows = decode_residuals(bytes, shape, kRows, kRows);
  ENGRAM_CHECK(rows.ok() == sizes.ok(), "readable in one way only");
  if (!rows.ok()) return;
  const auto first = decode_residuals(bytes, shape, kRows, 2);
  ENGRAM_CHECK(first.ok() && std::ranges::equal(*first, std::span(*rows).first(2)),
               "the first rows are others alone");
  for (size_t row = 0; row < kRows; ++row) {
    ENGRAM_CHECK((*sizes)[row].has_value() == !(*rows)[row].empty(), "bytes of no residual");
    if ((*rows)[row].empty()) continue;
    std::vector<uint8_t> image(shape.count(), 128);
    add_residual((*rows)[row], shape, image);
  }
}

/// The bytes as the code of one row behind fitting sizes.
std::vector<std::byte> as_row(std::span<const std::byte> code) {
  // Varints tell small numbers of either sign: twice the size, seven bits a byte.
  const size_t size = 2 * (code.size() + 1);
  std::vector<std::byte> bytes;
  for (size_t left = size; bytes.empty() || left > 0; left >>= 7)
    bytes.push_back(std::byte(static_cast<uint8_t>((left & 127) | (left > 127 ? 128 : 0))));
  bytes.resize(bytes.size() + kRows - 1);
  bytes.insert(bytes.end(), code.begin(), code.end());
  return bytes;
}

}  // namespace
}  // namespace engram::encoders

/// Whatever the bytes are, they are refused or give rows that can be added to images; behind
/// fitting sizes they always do. The first byte chooses the shape.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  using namespace engram::encoders;
  if (size < 1) return 0;
  const PixelShape& shape = kShapes[data[0] % kShapes.size()];
  const auto bytes = as_bytes(fuzzed_text(data + 1, size - 1));
  check_rows(bytes, shape);
  const auto row = as_row(bytes);
  ENGRAM_CHECK(decode_residuals(row, shape, kRows, kRows).ok(), "one row is refused");
  check_rows(row, shape);
  return 0;
}
