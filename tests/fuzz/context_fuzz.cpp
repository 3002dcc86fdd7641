// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/zstd.h"
#include "ltm/context/stored_context.h"
#include "ltm/core/byte_fields.h"
#include "tests/fuzz/fuzz_check.h"

namespace engram::ltm {
namespace {

/// What is unpacked is packed and unpacked to the same again, or is damaged.
void unpack_context_bytes(std::span<const std::byte> bytes) {
  const auto contexts = unpack_contexts(bytes);
  if (!contexts.ok()) {
    // An entity's name may be any text.
    ENGRAM_CHECK(contexts.status().code() == StatusCode::kDataLoss, "{}",
                 contexts.status().to_string());
    return;
  }
  const auto again = unpack_contexts(pack_contexts(*contexts));
  ENGRAM_CHECK(again.ok() && *again == *contexts, "contexts differ");
}

/// An index of one entity whose columns are these bytes.
std::vector<std::byte> index_of_columns(std::span<const std::byte> columns) {
  std::vector<std::byte> bytes;
  FieldWriter fields(bytes);
  fields.number(uint32_t{1});
  fields.number(uint32_t{1});
  fields.text("a/b/c/d");
  const auto packed = compress_zstd(columns, 1);
  fields.number(static_cast<uint64_t>(packed.size()));
  fields.bytes(packed);
  return bytes;
}

}  // namespace
}  // namespace engram::ltm

/// As a file or, to get further, as the columns of an entity.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  const auto text = fuzzed_text(data, size);
  ltm::unpack_context_bytes(as_bytes(text));
  ltm::unpack_context_bytes(ltm::index_of_columns(as_bytes(text)));
  return 0;
}
