// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/memory_id.h"

#include "tests/fuzz/fuzz_check.h"

/// What reads as an ID prints as text that reads to the same, with the same hash, and so do all
/// IDs above it.
int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace engram;
  const auto id = ltm::MemoryId::parse(fuzzed_text(bytes, size));
  if (!id.ok()) return 0;
  for (ltm::MemoryId above = *id;; above = above.parent()) {
    const auto again = ltm::MemoryId::parse(above.to_string());
    ENGRAM_CHECK(again.ok(), "{}", again.status().message());
    ENGRAM_CHECK(*again == above && again->hash() == above.hash(), "{}", above.to_string());
    ENGRAM_CHECK(above.is_prefix_of(*id), "{}", above.to_string());
    if (above.depth() == 0) return 0;
  }
}
