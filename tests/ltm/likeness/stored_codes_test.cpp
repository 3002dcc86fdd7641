// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/stored_codes.h"

#include "tests/ltm/expect_status.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

EntityCodes example_codes(const std::string& name, int64_t rows) {
  EntityCodes codes{example_entity(name), 42, {}, {}};
  for (int64_t i = 0; i < rows; ++i) {
    std::vector<int8_t> code(kCodeSize);
    for (size_t j = 0; j < kCodeSize; ++j)
      code[j] = static_cast<int8_t>(i * 7 + static_cast<int64_t>(j));
    codes.append(example_time(i), code);
  }
  return codes;
}

TEST(StoredCodes, AreReadAsTheyWerePacked) {
  const SegmentCodes codes{example_codes("cam", 40), example_codes("other", 0),
                           example_codes("wrist", 3)};
  const auto again = unpack_codes(pack_codes(codes));
  ASSERT_OK(again);
  ASSERT_EQ(again->size(), codes.size());
  for (size_t i = 0; i < codes.size(); ++i) {
    EXPECT_EQ((*again)[i].entity, codes[i].entity);
    EXPECT_EQ((*again)[i].space, codes[i].space);
    EXPECT_EQ((*again)[i].times, codes[i].times);
    EXPECT_EQ((*again)[i].codes, codes[i].codes);
  }
  const auto found = again->front().find(example_time(7));
  ASSERT_EQ(found.size(), kCodeSize);
  EXPECT_EQ(found[1], 50);
  EXPECT_TRUE(again->front().find(example_time(7) + Duration(1)).empty());
}

TEST(StoredCodes, AreRefusedWhereTheyAreDamaged) {
  const auto bytes = pack_codes({example_codes("cam", 40)});
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_EQ(unpack_codes(std::span(bytes).first(size)).status().code(), StatusCode::kDataLoss);
  EntityCodes backwards = example_codes("cam", 3);
  std::swap(backwards.times[0], backwards.times[2]);
  EXPECT_FAILS(unpack_codes(pack_codes({backwards})), StatusCode::kDataLoss, "run backwards");
}

}  // namespace
}  // namespace engram::ltm
