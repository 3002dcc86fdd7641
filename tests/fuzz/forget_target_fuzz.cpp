// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/forget_target.h"

#include "tests/fuzz/fuzz_check.h"

/// What a client sends to be forgotten asks for IDs alone, and an ID names itself.
int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace engram;
  const std::string text(fuzzed_text(bytes, size));
  const auto target = ltm::ForgetTarget::parse(text);
  if (!target.ok()) return 0;
  ENGRAM_CHECK(!target->meanings.empty(), "means nothing: {}", text);
  for (const ltm::Query& meaning : target->meanings)
    ENGRAM_CHECK(meaning.is_ids_only(), "asks for data: {}", text);
  if (!target->id || !target->id->has_entity()) return 0;
  const ltm::MemoryId entity = target->id->entity();
  ENGRAM_CHECK(target->meanings[0].matches(entity), "{}", text);
  return 0;
}
