// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/json.h"

#include "tests/fuzz/fuzz_check.h"

/// What reads as a value prints as JSON that reads to the same.
int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace engram;
  const auto value = idf::from_json_text(fuzzed_text(bytes, size));
  if (!value.ok()) return 0;
  const auto text = idf::to_json_text(*value);
  ENGRAM_CHECK(text.ok(), "{}", text.status().message());
  const auto again = idf::from_json_text(*text);
  ENGRAM_CHECK(again.ok(), "{}: {}", *text, again.status().message());
  ENGRAM_CHECK(*again == *value, "reads as another value: {}", *text);
  return 0;
}
