// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/mcap_records.h"

#include <gtest/gtest.h>

#include "ltm/core/byte_fields.h"
#include "tests/ltm/expect_status.h"

namespace engram::datasets::mcap {
namespace {

TEST(McapRecords, TheFieldThatDoesNotFitIsTold) {
  std::vector<std::byte> bytes;
  FieldWriter out(bytes);
  out.number(uint16_t{1});
  out.number(uint16_t{2});
  out.text("/topic");
  out.number(uint32_t{300});
  out.bytes(as_bytes("json"));
  EXPECT_FAILS(read_channel(bytes), StatusCode::kDataLoss,
               "channel record: byte 18 of 22, a field needs 300 more");
  EXPECT_FAILS(read_channel(std::span(bytes).first(3)), StatusCode::kDataLoss,
               "byte 2 of 3, a field needs 2 more");
}

TEST(McapRecords, TheFieldOfAMapThatDoesNotFitIsTold) {
  std::vector<std::byte> entries, bytes;
  FieldWriter inner(entries);
  inner.text("key");
  inner.text("value");
  inner.text("alone");
  FieldWriter out(bytes);
  out.text("name");
  out.sized(entries);
  EXPECT_FAILS(read_metadata(bytes), StatusCode::kDataLoss,
               "metadata record: byte 25 of 25, a field needs 4 more");
}

}  // namespace
}  // namespace engram::datasets::mcap
