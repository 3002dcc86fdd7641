// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/poke.h"

#include "tests/fuzz/fuzz_check.h"

/// Whatever somebody types as a poke: refused, or a name and a place that are finite.
int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace engram;
  const std::string_view text = fuzzed_text(bytes, size);
  const auto poke = datasets::kitchen::parse_poke(text);
  if (!poke.ok()) {
    ENGRAM_CHECK(poke.status().code() == StatusCode::kInvalidArgument, "{}",
                 poke.status().message());
    return 0;
  }
  ENGRAM_CHECK(!poke->name.empty(), "no name in {}", text);
  ENGRAM_CHECK(!poke->name.starts_with(' ') && !poke->name.ends_with(' '), "{}", text);
  ENGRAM_CHECK(!poke->is_away || !poke->surface, "away and on a surface: {}", text);
  ENGRAM_CHECK(poke->at.allFinite(), "{}", text);
  return 0;
}
