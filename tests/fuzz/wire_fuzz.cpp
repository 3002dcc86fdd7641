// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/binary.h"
#include "ltm/memory/commit.h"
#include "ltm/memory/result.h"
#include "tests/fuzz/fuzz_check.h"

namespace engram {
namespace {

/// What reads as a T writes a value that reads to the same.
template <typename T>
void check_form(const idf::Data& data) {
  const auto value = T::from_data(data);
  if (!value.ok()) return;
  const auto again = T::from_data(value->to_data());
  ENGRAM_CHECK(again.ok(), "{}", again.status().message());
  ENGRAM_CHECK(*again == *value, "reads as another value");
}

}  // namespace
}  // namespace engram

/// Whatever bytes a peer sends as a commit or a result: refused, or read and written alike.
int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace engram;
  const auto data = idf::decode(Buffer::copy(as_bytes(fuzzed_text(bytes, size))),
                                idf::kMaxDepth + idf::kContainerDepth);
  if (!data.ok()) return 0;
  check_form<ltm::Commit>(*data);
  check_form<ltm::QueryResult>(*data);
  return 0;
}
