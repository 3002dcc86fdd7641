// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/query.h"

#include "tests/fuzz/fuzz_check.h"

/// What reads as a query prints as text that reads to the same tree, which asks the same.
int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace engram;
  static const auto entity = ltm::MemoryId::parse("Vision/RGB/head/cam");
  const auto query = ltm::Query::parse(fuzzed_text(bytes, size));
  if (!query.ok()) return 0;
  const std::string text = query->to_string();
  const auto again = ltm::Query::parse(text);
  ENGRAM_CHECK(again.ok(), "{}", again.status().message());
  ENGRAM_CHECK(*again == *query, "reads as another query: {}", text);
  ENGRAM_CHECK(again->to_string() == text, "{} and {}", text, again->to_string());
  const auto tree = ltm::Query::create(query->memories(), query->is_ids_only());
  ENGRAM_CHECK(tree.ok() && *tree == *query, "is not in normal form: {}", text);
  ENGRAM_CHECK(again->snapshots_of(*entity) == query->snapshots_of(*entity), "{}", text);
  ENGRAM_CHECK(query->matches(*entity) == !query->snapshots_of(*entity).empty(), "{}", text);
  return 0;
}
