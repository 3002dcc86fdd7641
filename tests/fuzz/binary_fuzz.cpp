// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/binary.h"

#include "tests/fuzz/fuzz_check.h"

/// What decodes encodes again in as many bytes as announced, and decodes to the same.
int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace engram;
  const Buffer buffer = Buffer::copy(as_bytes(fuzzed_text(bytes, size)));
  const auto value = idf::decode(buffer);
  if (!value.ok()) return 0;
  const auto encoded = idf::encode(*value);
  ENGRAM_CHECK(encoded.ok(), "{}", encoded.status().message());
  ENGRAM_CHECK(encoded->size() == idf::encoded_size(*value), "{} bytes", encoded->size());
  const auto again = idf::decode(Buffer::copy(*encoded));
  ENGRAM_CHECK(again.ok() && *again == *value, "decodes to another value");
  return 0;
}
