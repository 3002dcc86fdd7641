// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "ltm/codec/codec.h"
#include "ltm/codec/column_codec.h"
#include "ltm/codec/group_codec.h"
#include "tests/fuzz/fuzz_check.h"

namespace engram::ltm {
namespace {

using idf::ElementType;

struct Wanted {
  ElementType type;
  idf::Shape shape;
};

const std::array<Wanted, 4>& wanted() {
  static const std::array<Wanted, 4> all{{{ElementType::kUInt8, {16, 24, 3}},
                                          {ElementType::kUInt8, {17, 16, 1}},
                                          {ElementType::kUInt16, {16, 16, 1}},
                                          {ElementType::kFloat32, {12, 9, 1}}}};
  return all;
}

void check(const idf::NdArray& array, const Wanted& needed) {
  ENGRAM_CHECK(array.type() == needed.type && array.shape() == needed.shape, "decodes to {} {}",
               to_string(array.type()), idf::to_string(array.shape()));
}

}  // namespace
}  // namespace engram::ltm

/// What decodes is of the type and shape that were asked for. The first byte chooses the codec, the
/// second one what is asked for.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  using namespace engram::ltm;
  if (size < 2) return 0;
  const auto bytes = as_bytes(fuzzed_text(data + 2, size - 2));
  const Wanted& needed = wanted()[data[1] % wanted().size()];
  const size_t codecs = all_codecs().size();
  const size_t groups = group_codec_names().size();
  const size_t choice = data[0] % (codecs + groups + 1);
  if (choice < codecs) {
    const auto array = all_codecs()[choice]->decode(bytes, needed.type, needed.shape);
    if (array.ok()) check(*array, needed);
  } else if (choice < codecs + groups) {
    const size_t count = 1 + data[1] / 64;
    const auto arrays = find_group_codec(group_codec_names()[choice - codecs])
                            ->decode(bytes, needed.type, needed.shape, count);
    if (!arrays.ok()) return 0;
    ENGRAM_CHECK(arrays->size() == count, "{} arrays", arrays->size());
    for (const auto& array : *arrays) check(array, needed);
  } else {
    const auto column = decompress_column(bytes, needed.type, 100);
    ENGRAM_CHECK(!column.ok() || column->size() == 100 * idf::size_bytes(needed.type), "{} bytes",
                 column->size());
  }
  return 0;
}
