// SPDX-License-Identifier: Apache-2.0
// Encrypted copies through the program: export, import, list, verify, forget.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "ltm/recording/recorder.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using VaultJson = nlohmann::json;

constexpr int kVaultDays = 3;
const Time kVaultStart = time_from_ns(1'645'142'400'000'000'000);  // 2022-02-18
const std::string kVaultCamera = "Vision/RGB/head/cam";

class VaultProgram : public ::testing::Test {
 protected:
  void SetUp() override {
    auto recorder = ltm::Recorder::open(store_, {});
    ASSERT_OK(recorder);
    for (int day = 0; day < kVaultDays; ++day)
      for (int i = 0; i < 5; ++i) record(*recorder, day, i);
    ASSERT_OK(recorder->close());
  }

  static void record(ltm::Recorder& recorder, int day, int i) {
    const Time time = kVaultStart + std::chrono::days(day) + std::chrono::minutes(i);
    ltm::Commit commit;
    for (const std::string& name : {kVaultCamera, std::string("Robot/\x1b[31mred/a\\/b/arm")}) {
      std::vector<uint8_t> pixels(30 * 40 * 3, static_cast<uint8_t>(day * 16 + i));
      commit.updates.push_back(
          {*ltm::MemoryId::parse(name),
           time,
           {{idf::Dict{{"image", idf::NdArray::take({30, 40, 3}, std::move(pixels))},
                       {"n", int64_t{i}}},
             {.created = time}}}});
    }
    ASSERT_OK(recorder.commit(commit));
  }

  [[nodiscard]] RunResult export_all() const {
    return run_engram({"export", store_, "--to", "vault", "-o", vault_, "--keys", keys_});
  }

  /// `engram vault PART VAULT --keys KEYS MORE...`
  [[nodiscard]] RunResult run_vault(const std::string& part,
                                    const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all{"vault", part, vault_, "--keys", keys_};
    all.insert(all.end(), more.begin(), more.end());
    return run_engram(all);
  }

  [[nodiscard]] RunResult import_into(const std::string& store) const {
    return run_engram({"import", "--from", vault_, "--keys", keys_, store, "--json"});
  }

  static VaultJson all_of(const std::string& store) {
    const RunResult asked = run_engram({"query", store, "@ all", "--json"});
    EXPECT_EQ(asked.exit_code, 0) << asked.err;
    return VaultJson::parse(asked.out);
  }

  ScratchDirectory directory_;
  std::string store_ = directory_ / "robot.engram";
  std::string vault_ = directory_ / "robot.vault";
  std::string keys_ = directory_ / "robot.keys";
};

TEST_F(VaultProgram, CopiesAndGivesBack) {
  const RunResult out = export_all();
  EXPECT_EQ(out.exit_code, 0) << out.err;
  EXPECT_THAT(out.out, HasSubstr("6 entity-days are new"));
  EXPECT_THAT(export_all().out, HasSubstr("0 entity-days are new, 0 replaced, 6 as before"));
  const std::string back = directory_ / "back.engram";
  const RunResult in = import_into(back);
  EXPECT_EQ(in.exit_code, 0) << in.err;
  EXPECT_EQ(VaultJson::parse(in.out).at("snapshots"), 2 * kVaultDays * 5);
  EXPECT_EQ(all_of(store_).at("entities"), all_of(back).at("entities"));
  EXPECT_EQ(run_engram({"check", back, "--deep"}).exit_code, 0);
}

TEST_F(VaultProgram, ListsAndVerifies) {
  ASSERT_EQ(export_all().exit_code, 0);
  const RunResult list = run_vault("list");
  EXPECT_EQ(list.exit_code, 0) << list.err;
  EXPECT_THAT(list.out, HasSubstr("2022-02-19"));
  EXPECT_THAT(list.out, Not(HasSubstr("\x1b"))) << "names are no orders to a terminal";
  const VaultJson json = VaultJson::parse(run_vault("list", {"--json"}).out);
  EXPECT_EQ(json.at("days").size(), 6U);
  EXPECT_THAT(run_vault("verify").out, HasSubstr("Whole"));
  const RunResult without = run_engram({"vault", "verify", vault_, "--json"});
  EXPECT_EQ(without.exit_code, 0) << without.err;
  EXPECT_FALSE(VaultJson::parse(without.out).at("had_keys"));
  // Damage has exit code 3 and a name.
  const std::string file =
      std::filesystem::path(vault_) / json.at("days").at(0).at("file").get<std::string>();
  {
    std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
    bytes.seekp(200);
    bytes.put('~');
  }
  const RunResult damaged = run_vault("verify", {"--json"});
  EXPECT_EQ(damaged.exit_code, 3) << damaged.err;
  EXPECT_EQ(VaultJson::parse(damaged.out).at("damaged").at(0).at("day"), "2022-02-18");
  const RunResult in = import_into(directory_ / "back.engram");
  EXPECT_EQ(in.exit_code, 3) << in.err;
}

TEST_F(VaultProgram, ForgetsDays) {
  ASSERT_EQ(export_all().exit_code, 0);
  const RunResult plan = run_vault("forget", {"Vision @ 2022-02-19", "--dry-run"});
  EXPECT_EQ(plan.exit_code, 0) << plan.err;
  EXPECT_THAT(plan.out, HasSubstr("2022-02-19"));
  EXPECT_THAT(plan.out, Not(HasSubstr("2022-02-18")));
  EXPECT_EQ(run_vault("forget", {"Vision @ 2022-02-19"}).exit_code, 2) << "nobody to ask";
  EXPECT_EQ(run_vault("forget", {"Vision @ latest", "--yes"}).exit_code, 1);
  EXPECT_EQ(VaultJson::parse(run_vault("list", {"--json"}).out).at("days").size(), 6U);
  const RunResult done = run_vault("forget", {"Vision @ 2022-02-19", "--yes", "--json"});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(VaultJson::parse(done.out).at("is_done"));
  const RunResult in = import_into(directory_ / "back.engram");
  EXPECT_EQ(in.exit_code, 0) << "what was forgotten on purpose is no damage";
  EXPECT_EQ(VaultJson::parse(in.out).at("destroyed"), 1);
  EXPECT_EQ(VaultJson::parse(in.out).at("snapshots"), 2 * kVaultDays * 5 - 5);
  EXPECT_THAT(export_all().out, HasSubstr("1 entity-days are left out"));
  // Without the vault as well.
  std::filesystem::rename(vault_, vault_ + ".away");
  const RunResult far = run_vault("forget", {"Robot", "--yes"});
  EXPECT_EQ(far.exit_code, 0) << far.err;
  EXPECT_THAT(far.out, HasSubstr("their files stay where the vault is"));
}

TEST_F(VaultProgram, SaysWhatIsWrongWithArguments) {
  const auto expect_wrong = [](const std::vector<std::string>& arguments, int code,
                               const std::string& part) {
    const RunResult result = run_engram(arguments);
    EXPECT_EQ(result.exit_code, code) << result.out << result.err;
    EXPECT_THAT(result.err, HasSubstr(part));
  };
  expect_wrong({"export", store_, "--to", "vault", "-o", vault_}, 2, "needs --keys");
  expect_wrong({"export", store_, "--to", "vault", "-o", vault_, "--keys", vault_ + "/keys"}, 1,
               "inside the vault");
  expect_wrong({"export", store_, "--to", "jsonl", "-o", vault_, "--keys", keys_}, 2,
               "is for a vault");
  ASSERT_EQ(export_all().exit_code, 0);
  expect_wrong({"import", "--from", vault_, directory_ / "back.engram"}, 2, "needs --keys");
  expect_wrong({"import", "--from", vault_, "--keys", keys_, "--preset", "small",
                directory_ / "back.engram"},
               2, "--preset");
  EXPECT_FALSE(std::filesystem::exists(directory_ / "back.engram"));
  std::filesystem::permissions(keys_, std::filesystem::perms::others_read,
                               std::filesystem::perm_options::add);
  expect_wrong({"vault", "list", vault_, "--keys", keys_}, 1, "chmod 600");
}

TEST_F(VaultProgram, KilledAtAnyMomentItGoesOn) {
  {
    auto recorder = ltm::Recorder::open(store_, {});
    ASSERT_OK(recorder);
    for (int day = kVaultDays; day < 40; ++day)
      for (int i = 0; i < 20; ++i) record(*recorder, day, i);
    ASSERT_OK(recorder->close());
  }
  const std::vector<std::string> command{"export", store_, "--to",   "vault",
                                         "-o",     vault_, "--keys", keys_};
  int killed = 0;
  for (int round = 0; round < 10; ++round) {
    killed += run_engram_and_kill(command, 20 + 15 * round).exit_code < 0 ? 1 : 0;
    if (!std::filesystem::exists(vault_ + "/engram.vault")) continue;
    const RunResult part = run_vault("verify");
    EXPECT_EQ(part.exit_code, 0) << part.out << part.err;
  }
  EXPECT_GT(killed, 0);
  EXPECT_EQ(run_engram(command).exit_code, 0);
  const std::string back = directory_ / "back.engram";
  for (int round = 0; round < 4; ++round)
    run_engram_and_kill({"import", "--from", vault_, "--keys", keys_, back}, 30 + 30 * round);
  EXPECT_EQ(import_into(back).exit_code, 0);
  EXPECT_EQ(all_of(store_).at("entities"), all_of(back).at("entities"));
}

}  // namespace
}  // namespace engram::cli
