// SPDX-License-Identifier: Apache-2.0
// Every change of a vault's files is found, and what is whole is read all the same.
#include "tests/datasets/vault/vault_fixture.h"

namespace engram::datasets::vault {
namespace {

class VaultDamage : public VaultFixture {
 protected:
  void SetUp() override {
    make_store();
    exported();
  }

  /// Expects that `path` with these bytes is found to be damaged, and restores it.
  void expect_found(const std::filesystem::path& path, const std::string& bytes,
                    const std::string& what) {
    const std::string whole = content(path);
    ASSERT_NE(whole, bytes) << what;
    overwrite(path, bytes);
    const auto report = check_vault(places_, {}, {});
    ASSERT_OK(report);
    EXPECT_EQ(report->damaged.size(), 1U) << what;
    overwrite(path, whole);
  }
};

TEST_F(VaultDamage, EveryFlippedByteOfAFileIsFound) {
  const auto path = file_of(arm(), kFirstDay);
  const std::string whole = content(path);
  ASSERT_GT(whole.size(), 500U);
  for (size_t at = 0; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << (at % 8)));
    // Opening and reading it is what verifying does, without the other files.
    overwrite(path, bytes);
    auto reader = DayReader::open(path, arm(), kFirstDay, *keys().find(arm(), kFirstDay));
    Status status = reader.status();
    while (status.ok()) {
      const auto next = reader->next();
      status = next.status();
      if (next.ok() && !*next) break;
    }
    EXPECT_EQ(status.code(), StatusCode::kDataLoss) << "byte " << at << ": " << status.to_string();
  }
}

TEST_F(VaultDamage, AFileThatEndsEarlyOrGoesOnIsFound) {
  const auto path = file_of(camera(), kFirstDay);
  const std::string whole = content(path);
  for (size_t size = 0; size < whole.size(); size += whole.size() / 40)
    expect_found(path, whole.substr(0, size), "cut at " + std::to_string(size));
  expect_found(path, whole + "x", "one byte more");
  expect_found(path, whole + whole, "twice");
}

TEST_F(VaultDamage, ExchangedFilesAreFound) {
  const auto first = file_of(arm(), kFirstDay), second = file_of(arm(), kFirstDay + 1);
  const std::string one = content(first), two = content(second);
  overwrite(first, two);
  overwrite(second, one);
  EXPECT_EQ(checked().damaged.size(), 2U);
  // The header tells it first, so it is made to fit: the seals do not.
  overwrite(first, one.substr(0, kSealedHeaderBytes) + two.substr(kSealedHeaderBytes));
  overwrite(second, two.substr(0, kSealedHeaderBytes) + one.substr(kSealedHeaderBytes));
  EXPECT_EQ(checked().damaged.size(), 2U);
  overwrite(first, one);
  overwrite(second, two);
  EXPECT_TRUE(checked().is_whole());
}

TEST_F(VaultDamage, CostsOnlyTheDayThatItHit) {
  const auto path = file_of(camera(), kFirstDay);
  std::string bytes = content(path);
  bytes[bytes.size() / 2] ^= 1;
  overwrite(path, bytes);
  const auto in = imported(scratch_ / "back");
  ASSERT_EQ(in.damaged.size(), 1U);
  EXPECT_EQ(in.damaged[0].entity, camera());
  EXPECT_EQ(in.damaged[0].day, kFirstDay);
  EXPECT_EQ(in.damaged[0].file, path.filename().string());
  EXPECT_EQ(answers(store_, "Body @ all"), answers(scratch_ / "back", "Body @ all"));
  expect_whole_store(scratch_ / "back");
}

TEST_F(VaultDamage, WithoutKeysTheStructureIsChecked) {
  VaultPlaces without{places_.vault, {}};
  const auto whole = check_vault(without, {}, {});
  ASSERT_OK(whole);
  EXPECT_TRUE(whole->is_whole());
  EXPECT_FALSE(whole->had_keys);
  EXPECT_EQ(whole->files, 9U);
  const auto path = file_of(arm(), kFirstDay);
  overwrite(path, content(path).substr(0, 40));
  EXPECT_EQ(check_vault(without, {}, {})->damaged.size(), 1U);
}

TEST_F(VaultDamage, TheFileThatNamesTheVaultIsNeededForNothingElse) {
  overwrite(places_.vault / "engram.vault", "rubbish");
  EXPECT_EQ(checked().damaged.size(), 1U);
  EXPECT_EQ(imported(scratch_ / "back").snapshots, 3U * kDays * kPerDay);
  exported();
  EXPECT_TRUE(checked().is_whole());
}

TEST_F(VaultDamage, EveryFlippedByteOfAKeyFileIsFound) {
  const std::string whole = content(places_.keys);
  for (size_t at = 0; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << (at % 8)));
    const auto found = decode_keys(as_bytes(bytes));
    EXPECT_FALSE(found.ok()) << "byte " << at;
  }
  for (size_t size = 0; size < whole.size(); size += 7)
    EXPECT_FALSE(decode_keys(as_bytes(whole.substr(0, size))).ok()) << size;
}

}  // namespace
}  // namespace engram::datasets::vault
