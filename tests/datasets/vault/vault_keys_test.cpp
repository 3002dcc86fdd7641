// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/vault_keys.h"

#include "tests/ltm/expect_status.h"

namespace engram::datasets::vault {
namespace {

ltm::MemoryId entity(const std::string& name) {
  return *ltm::MemoryId::from_names({"Vision", "RGB", "head", name});
}

RandomId random_id() {
  RandomId id{};
  EXPECT_OK(fill_random(id));
  return id;
}

VaultKeys some_keys() {
  VaultKeys keys;
  keys.vault = random_id();
  keys.store_id = "a store";
  EXPECT_OK(keys.types.declare(entity("cam").parent(), idf::Type::float64()));
  for (const Day day : {-3, 0, 19'000}) {
    VaultDay kept;
    kept.file = random_id();
    kept.key = *SecretKey::random();
    kept.snapshots = 7;
    kept.first = day_begin(day);
    kept.last = day_end(day);
    kept.source = UINT64_MAX;
    keys.days[entity("cam")][day] = kept;
    keys.destroyed[entity("a/b\n")][day] = {random_id(), time_from_ns(day)};
  }
  keys.obsolete = {random_id(), random_id()};
  return keys;
}

TEST(VaultKeysFile, GivesBackWhatWasWritten) {
  const VaultKeys keys = some_keys();
  const auto bytes = encode_keys(keys);
  ASSERT_OK(bytes);
  const auto found = decode_keys(*bytes);
  ASSERT_OK(found);
  EXPECT_EQ(found->vault, keys.vault);
  EXPECT_EQ(found->store_id, keys.store_id);
  EXPECT_EQ(found->types, keys.types);
  EXPECT_EQ(found->obsolete, keys.obsolete);
  EXPECT_EQ(found->day_count(), 3U);
  EXPECT_EQ(found->destroyed_count(), 3U);
  EXPECT_TRUE(found->is_destroyed(entity("a/b\n"), -3));
  const VaultDay &day = *found->find(entity("cam"), -3), &was = *keys.find(entity("cam"), -3);
  EXPECT_EQ(day.file, was.file);
  EXPECT_TRUE(std::ranges::equal(day.key.bytes(), was.key.bytes()));
  EXPECT_EQ(day.snapshots, 7U);
  EXPECT_EQ(day.first, was.first);
  EXPECT_EQ(day.last, was.last);
  EXPECT_EQ(day.source, UINT64_MAX);
  EXPECT_EQ(found->find(entity("cam"), 1), nullptr);
}

TEST(VaultKeysFile, RefusesWhatContradictsItself) {
  VaultKeys keys = some_keys();
  const RandomId file = keys.days[entity("cam")][0].file;
  keys.days[entity("other")][0].file = file;
  EXPECT_FAILS(decode_keys(*encode_keys(keys)), StatusCode::kDataLoss, "one file");
  keys = some_keys();
  keys.destroyed[entity("cam")][0].file = random_id();
  EXPECT_FAILS(decode_keys(*encode_keys(keys)), StatusCode::kDataLoss, "one file or day");
}

TEST(VaultKeysFile, TellsANewerVersion) {
  SecretBytes bytes = *encode_keys(some_keys());
  bytes[8] = std::byte{9};
  EXPECT_FAILS(decode_keys(bytes), StatusCode::kFailedPrecondition, "version 9");
}

TEST(VaultDays, BeginAndEndAsUtcDoes) {
  EXPECT_EQ(day_text(0), "1970-01-01");
  EXPECT_EQ(day_text(-1), "1969-12-31");
  EXPECT_EQ(day_of(time_from_ns(-1)), -1);
  EXPECT_EQ(day_of(day_begin(19'041)), 19'041);
  EXPECT_EQ(day_of(day_end(19'041)), 19'041);
  EXPECT_EQ(day_end(5) + Duration(1), day_begin(6));
  for (const Time edge : {Time::min(), Time::max()}) {
    EXPECT_LE(day_begin(day_of(edge)), edge);
    EXPECT_GE(day_end(day_of(edge)), edge);
  }
  EXPECT_EQ(*parse_day("2022-02-18"), 19'041);
  EXPECT_EQ(day_text(*parse_day("2024-02-29")), "2024-02-29");
  for (const char* wrong : {"2022-02-30", "2022-2-18", "20220218", "2022-02-18 ", "x022-02-18",
                            "2022-02-1x", "-022-02-18", ""})
    EXPECT_EQ(parse_day(wrong).status().code(), StatusCode::kInvalidArgument) << wrong;
}

}  // namespace
}  // namespace engram::datasets::vault
