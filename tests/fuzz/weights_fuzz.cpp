// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "encoders/coding/background_coder.h"
#include "encoders/coding/checked_block.h"
#include "encoders/coding/weight_coder.h"
#include "ltm/core/buffer.h"
#include "tests/fuzz/fuzz_check.h"

namespace engram::encoders {
namespace {

std::vector<std::byte> sealed(std::span<const std::byte> bytes, uint64_t covered) {
  return with_checksum({bytes.begin(), bytes.end()}, covered);
}

void check_weights(std::span<const std::byte> bytes, size_t rows, size_t columns) {
  WeightCoder reader;
  const auto block = sealed(bytes, shape_identity(rows, columns));
  for (int matrix = 0; matrix < 2; ++matrix) {  // The second by what the first one taught.
    const auto weights = reader.decode(block, rows, columns, "weights");
    ENGRAM_CHECK(weights.ok() && weights->size() == rows * columns, "other weights");
    const auto again = WeightCoder().decode(WeightCoder().encode(*weights, columns), rows, columns,
                                            "weights written again");
    ENGRAM_CHECK(again.ok() && *again == *weights, "written again they are others");
  }
}

void check_backgrounds(std::span<const std::byte> bytes, size_t scenes, const LatentGrid& shape) {
  const auto pixels = decode_backgrounds(sealed(bytes, scenes_identity(scenes, shape)), scenes,
                                         shape, "backgrounds");
  ENGRAM_CHECK(pixels.ok() && pixels->size() == scenes * shape.count(), "other backgrounds");
  const auto again = decode_backgrounds(encode_backgrounds(*pixels, shape), scenes, shape,
                                        "backgrounds written again");
  ENGRAM_CHECK(again.ok() && *again == *pixels, "written again they are others");
}

}  // namespace
}  // namespace engram::encoders

/// Whatever stands behind a fitting checksum, as many weights and grey levels are read as were
/// asked for, and can be written again. The first byte chooses the shape.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  using namespace engram::encoders;
  if (size < 1) return 0;
  const auto bytes = as_bytes(fuzzed_text(data + 1, size - 1));
  const size_t rows = 1 + data[0] % 7, columns = 1 + data[0] / 7;
  check_weights(bytes, rows, columns);
  const int height = 1 + data[0] / 4 % 8, width = 1 + data[0] / 32;
  check_backgrounds(bytes, 1 + data[0] % 2, {1 + data[0] / 2 % 2 * 2, height, width});
  return 0;
}
