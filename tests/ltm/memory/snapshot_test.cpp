// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/snapshot.h"

#include "ltm/idf/binary.h"
#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

TEST(Snapshot, CountsTheBytesOfItsPlainValues) {
  const MemoryId entity = *MemoryId::parse("a/b/c/d");
  const idf::Data value = idf::Dict{
      {"image", idf::NdArray::take<uint8_t>({10, 10, 3}, std::vector<uint8_t>(300))}, {"x", 1.0}};
  Snapshot snapshot{entity, time_from_ns(5), {{value, {}}}};
  EXPECT_EQ(snapshot.raw_bytes(), idf::encode(value)->size());
  EXPECT_GT(snapshot.raw_bytes(), 300u);
  snapshot.instances.push_back({idf::Data(true), {}});
  EXPECT_EQ(snapshot.raw_bytes(), idf::encode(value)->size() + 5);
  EXPECT_EQ(Snapshot{}.raw_bytes(), 0u);
  EXPECT_EQ(snapshot.id(), entity.at(time_from_ns(5)));
}

}  // namespace
}  // namespace engram::ltm
