// SPDX-License-Identifier: Apache-2.0
#include "viewer/request_target.h"

#include "tests/fuzz/fuzz_check.h"

/// What a browser asks for is text and within its bounds, and taking a parameter out leaves a
/// target that has all others.
int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace engram;
  using viewer::RequestTarget;
  const std::string text(fuzzed_text(bytes, size));
  const auto target = RequestTarget::parse(text);
  if (!target.ok()) return 0;
  ENGRAM_CHECK(target->path().starts_with('/'), "{}", text);
  ENGRAM_CHECK(target->path().find('\0') == std::string::npos, "{}", text);
  for (const char* name : {"entity", "id", "at", "pixels", "horizon", "token", ""}) {
    const auto first = target->find(name);
    const auto all = target->all(name);
    ENGRAM_CHECK(first.has_value() == !all.empty(), "'{}' in {}", name, text);
    if (first) ENGRAM_CHECK(*first == all.front(), "'{}' in {}", name, text);
    const auto rest = RequestTarget::parse("/" + target->query_without(name));
    ENGRAM_CHECK(rest.ok(), "without '{}': {}", name, text);
    ENGRAM_CHECK(!rest->find(name), "without '{}': {}", name, text);
  }
  if (const auto number = target->integer("pixels", 1, 65536); number.ok())
    ENGRAM_CHECK(*number >= 1 && *number <= 65536, "{}", text);
  if (const auto horizons = target->integers("horizon", 1, 1000, 16); horizons.ok())
    ENGRAM_CHECK(!horizons->empty() && horizons->size() <= 16, "{}", text);
  if (const auto entity = target->entity("entity"); entity.ok())
    ENGRAM_CHECK(entity->has_entity() && !entity->time(), "{}", text);
  if (const auto moment = target->moment("id"); moment.ok())
    ENGRAM_CHECK(moment->time().has_value(), "{}", text);
  return 0;
}
