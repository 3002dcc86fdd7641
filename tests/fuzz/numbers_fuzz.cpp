// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/checked_block.h"
#include "encoders/coding/number_codec.h"
#include "ltm/core/buffer.h"
#include "tests/fuzz/fuzz_check.h"

/// Whatever a model and a block hold behind fitting checksums, as many rows decode as were asked
/// for, and a model is the same after its bytes. The first two bytes are the length of the model.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  using namespace engram::encoders;
  constexpr size_t kRows = 6;
  if (size < 2) return 0;
  const auto bytes = as_bytes(fuzzed_text(data + 2, size - 2));
  const size_t length = std::min<size_t>(data[0] + 256u * data[1], bytes.size());
  const auto model_bytes = bytes.first(length), block = bytes.subspan(length);
  const auto model =
      NumberModel::from_bytes(with_checksum({model_bytes.begin(), model_bytes.end()}));
  if (!model.ok()) return 0;
  ENGRAM_CHECK(NumberModel::from_bytes(model->to_bytes()).ok(), "lost in its bytes");
  if (model->count() > 64) return 0;  // The search stays quick.
  const auto rows =
      NumberCodec(*model).decode(with_checksum({block.begin(), block.end()}, kRows), kRows);
  ENGRAM_CHECK(rows.ok() && rows->size() == kRows * model->count(), "found other rows");
  return 0;
}
