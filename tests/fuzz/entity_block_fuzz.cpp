// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/zstd.h"
#include "ltm/idf/base64.h"
#include "ltm/store/segment_entities.h"
#include "tests/fuzz/fuzz_check.h"

namespace engram::ltm {
namespace {

/// What is packed as `text` is unpacked as it says, or is damaged: then nothing of it is found.
void unpack(std::string text, uint64_t count) {
  static const auto first = *MemoryId::parse("Objects/Things/room/thing 1");
  const auto entities = SegmentEntities::from_blocks({{first, count, std::move(text)}});
  ENGRAM_CHECK(entities.ok(), "{}", entities.status().to_string());
  const Status whole = entities->verify();
  ENGRAM_CHECK(whole.ok() || whole.code() == StatusCode::kDataLoss, "{}", whole.to_string());
  uint64_t found = 0;
  for (const SegmentEntity& entity : *entities) {
    ++found;
    ENGRAM_CHECK(entities->find(entity.id) != nullptr, "an entity is not found");
  }
  ENGRAM_CHECK(found == (whole.ok() ? count : 0), "{} entities of {}", found, count);
  const auto again = pack_in_blocks({entities->begin(), entities->end()});
  ENGRAM_CHECK(again.ok(), "{}", again.status().to_string());
}

}  // namespace
}  // namespace engram::ltm

/// The first byte is the count of entities, the rest is packed or, to get further, plain.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  if (size < 2 || data[0] == 0) return 0;
  const auto text = fuzzed_text(data + 1, size - 1);
  ltm::unpack(std::string(text), data[0]);
  ltm::unpack(idf::to_base64(ltm::compress_zstd(as_bytes(text), 1)), data[0]);
  return 0;
}
