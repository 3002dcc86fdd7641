// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/type_xml.h"

#include "ltm/idf/cast.h"
#include "ltm/idf/type_check.h"
#include "tests/fuzz/fuzz_check.h"

/// What reads as types is stored and reads back to the same, and has default values that fit.
int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace engram;
  const auto file = idf::parse_type_xml(fuzzed_text(bytes, size), "fuzz.xml", {});
  if (!file.ok()) return 0;
  for (const idf::Type& type : file->types) {
    const auto again = idf::type_from_data(idf::to_data(type));
    ENGRAM_CHECK(again.ok(), "{}", again.status().message());
    ENGRAM_CHECK(*again == type, "reads as another type: {}", idf::to_string(type));
    ENGRAM_CHECK(idf::check(idf::default_value(type), type).empty(), "default does not fit: {}",
                 idf::to_string(type));
  }
  return 0;
}
