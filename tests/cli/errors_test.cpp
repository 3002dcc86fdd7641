// SPDX-License-Identifier: Apache-2.0
// What users get wrong, and what the world does to files: each names the object, what was found
// and what was needed, with the exit code of the design.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "ltm/recording/recorder.h"
#include "ltm/store/manifest.h"
#include "tests/cli/run_program.h"
#include "tests/faults/faulty_files.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;
constexpr int kDoneWithLoss = 3;

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Errors : public ::testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return directory_.path() / name; }

  /// An import whose table or video was replaced.
  RunResult import(const std::string& video, const std::string& table) {
    return run_engram(import_arguments({video, table}, path("store")));
  }

  ScratchDirectory directory_;
};

TEST_F(Errors, MissingVideoIsNamed) {
  write(path("t.csv"), "timestamp,a\n0,1\n");
  const RunResult result = import(path("none.mp4"), path("t.csv"));
  EXPECT_EQ(result.exit_code, kFailed);
  EXPECT_THAT(result.err, HasSubstr("none.mp4"));
}

TEST_F(Errors, BrokenVideoIsNamed) {
  write(path("noise.mp4"), std::string(5000, 'x'));
  write(path("t.csv"), "timestamp,a\n0,1\n");
  const RunResult result = import(path("noise.mp4"), path("t.csv"));
  EXPECT_EQ(result.exit_code, kFailed);
  EXPECT_THAT(result.err, HasSubstr("noise.mp4"));
}

TEST_F(Errors, TruncatedVideoKeepsWhatCameBefore) {
  const Recording recording = make_recording(directory_.path(), 6);
  const std::string whole = read(recording.video);
  write(path("cut.mp4"), whole.substr(0, whole.size() * 2 / 3));
  const RunResult result = import(path("cut.mp4"), recording.table);
  EXPECT_THAT(result.exit_code, ::testing::AnyOf(kFailed, kDoneWithLoss)) << result.err;
  EXPECT_THAT(result.err, HasSubstr("cut.mp4"));
}

/// Runs an import whose disk is dead from its n-th change on.
RunResult import_onto_dying_disk(const std::vector<std::string>& arguments, const std::string& root,
                                 int change) {
  const std::map<std::string, std::string> environment{
      {"LD_PRELOAD", FAULTY_FILES},
      {"ASAN_OPTIONS", "verify_asan_link_order=0"},
      {"ENGRAM_FAULTS_ROOT", root},
      {"ENGRAM_FAULTS_CALL", std::to_string(change)},
      {"ENGRAM_FAULTS_KIND", std::to_string(kFaultDead)}};
  for (const auto& [name, value] : environment) ::setenv(name.c_str(), value.c_str(), 1);
  RunResult result = run_engram(arguments);
  for (const auto& [name, value] : environment) ::unsetenv(name.c_str());
  return result;
}

TEST_F(Errors, DiskThatDiesIsToldWithWhatAPowerCutMayCost) {
  const auto arguments = import_arguments(make_recording(directory_.path(), 4), path("store"));
  const RunResult result = import_onto_dying_disk(arguments, path("store"), 40);
  EXPECT_EQ(result.exit_code, kFailed);
  EXPECT_THAT(result.err, AllOf(HasSubstr("Input/output error"),
                                HasSubstr("a power cut may cost what was kept last")));
}

TEST_F(Errors, ColumnThatIsNotNumericIsNamedWithItsLine) {
  const Recording recording = make_recording(directory_.path(), 1);
  write(path("t.csv"), "timestamp,left,right\n0,1,2\n0.1,1,apple\n");
  const RunResult result = import(recording.video, path("t.csv"));
  EXPECT_EQ(result.exit_code, kFailed);
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("t.csv"), HasSubstr("right"), HasSubstr("apple"), HasSubstr("3")));
}

TEST_F(Errors, TimeThatRunsBackwardsIsNamedWithItsLine) {
  const Recording recording = make_recording(directory_.path(), 1);
  write(path("t.csv"), "timestamp,a\n0,1\n0.2,1\n0.1,1\n");
  const RunResult result = import(recording.video, path("t.csv"));
  EXPECT_EQ(result.exit_code, kFailed);
  EXPECT_THAT(result.err, AllOf(HasSubstr("t.csv"), HasSubstr("4")));
}

TEST_F(Errors, SecondImportOfTheSameTimeSaysWhichStartFits) {
  const Recording recording = make_recording(directory_.path(), 1);
  ASSERT_EQ(import(recording.video, recording.table).exit_code, 0);
  const RunResult again = import(recording.video, recording.table);
  EXPECT_EQ(again.exit_code, kFailed);
  EXPECT_THAT(again.err, AllOf(HasSubstr(kCamera), HasSubstr("2022-02-18 13:00:0")));
  const RunResult info = run_engram({"info", path("store"), "--json"});
  EXPECT_EQ(nlohmann::json::parse(info.out).at("entities").at(1).at("snapshots"), 5);
}

TEST_F(Errors, UnknownEntityNamesTheKnownOnes) {
  const Recording recording = make_recording(directory_.path(), 1);
  ASSERT_EQ(import(recording.video, recording.table).exit_code, 0);
  const RunResult result = run_engram({"query", path("store"), "Vision/RGB/head/eye @ latest"});
  EXPECT_EQ(result.exit_code, kFailed);
  EXPECT_THAT(result.err, AllOf(HasSubstr("eye"), HasSubstr(kCamera)));
}

TEST_F(Errors, EmptyStoreIsShownAndHasNothingToAnswer) {
  ASSERT_TRUE(ltm::create_store(path("store")).ok());
  const RunResult info = run_engram({"info", path("store")});
  EXPECT_EQ(info.exit_code, 0);
  EXPECT_THAT(info.out, HasSubstr("empty"));
  EXPECT_EQ(run_engram({"query", path("store"), "@ latest"}).exit_code, kFailed);
  EXPECT_EQ(run_engram({"consolidate", path("store")}).exit_code, kFailed);
}

TEST_F(Errors, InfoTellsWhoMayReadAStore) {
  ASSERT_TRUE(ltm::create_store(path("store")).ok());
  for (const bool others : {true, false}) {
    std::filesystem::permissions(path("store"), std::filesystem::perms(others ? 0755 : 0750));
    const RunResult info = run_engram({"info", path("store"), "--security", "--json"});
    ASSERT_EQ(info.exit_code, 0) << info.err;
    const auto json = nlohmann::ordered_json::parse(info.out);
    EXPECT_EQ(json["others_may_read"], others);
    EXPECT_THAT(json["disk"], ::testing::AnyOf("encrypted", "not encrypted", "unknown"));
    EXPECT_NE(json["reason"], "");
  }
  EXPECT_EQ(run_engram({"info", path("none"), "--security"}).exit_code, kFailed);
  EXPECT_EQ(run_engram({"info", "--security"}).exit_code, kWrongUsage);
}

TEST_F(Errors, StoreOfANewerFormatIsRefused) {
  ASSERT_TRUE(ltm::create_store(path("store")).ok());
  auto manifest = nlohmann::ordered_json::parse(read(path("store/MANIFEST.json")));
  manifest["format_version"] = 999;
  write(path("store/MANIFEST.json"), manifest.dump());
  for (const auto& command : {std::vector<std::string>{"info", path("store")},
                              {"query", path("store"), "@ latest"},
                              {"consolidate", path("store")},
                              {"eval", path("store")}}) {
    const RunResult result = run_engram(command);
    EXPECT_EQ(result.exit_code, kFailed) << command[0];
    EXPECT_THAT(result.err, AllOf(HasSubstr("999"), HasSubstr("up to 3"))) << command[0];
  }
}

TEST_F(Errors, DirectoryThatIsNoStoreIsRefused) {
  write(path("letter.txt"), "hello");
  const RunResult result = run_engram({"info", directory_.path()});
  EXPECT_EQ(result.exit_code, kFailed);
  EXPECT_THAT(result.err, AllOf(HasSubstr("no store"), HasSubstr("MANIFEST.json")));
  EXPECT_EQ(run_engram({"info", path("nowhere")}).exit_code, kFailed);
  const Recording recording = make_recording(directory_.path(), 1);
  const RunResult import_into = run_engram(import_arguments(recording, directory_.path()));
  EXPECT_EQ(import_into.exit_code, kFailed);
  EXPECT_EQ(read(path("letter.txt")), "hello");
}

TEST_F(Errors, BrokenManifestIsNamed) {
  ASSERT_TRUE(ltm::create_store(path("store")).ok());
  write(path("store/MANIFEST.json"), "{\"format\": ");
  const RunResult result = run_engram({"info", path("store")});
  EXPECT_EQ(result.exit_code, kFailed);
  EXPECT_THAT(result.err, HasSubstr("MANIFEST.json"));
}

TEST_F(Errors, WrongUsageExitsWithTwo) {
  EXPECT_EQ(run_engram({}).exit_code, kWrongUsage);
  EXPECT_EQ(run_engram({"fly"}).exit_code, kWrongUsage);
  EXPECT_EQ(run_engram({"info"}).exit_code, kWrongUsage);
  EXPECT_EQ(run_engram({"query", path("store"), "a/b/c/d/e @ latest"}).exit_code, kWrongUsage);
  EXPECT_EQ(run_engram({"query", path("store"), "a @ tomorrow"}).exit_code, kWrongUsage);
  EXPECT_EQ(run_engram({"consolidate", path("store"), "--budget", "soon"}).exit_code, kWrongUsage);
  EXPECT_EQ(run_engram({"import", "--video", "v", "--entity", "a/b", path("store")}).exit_code,
            kWrongUsage);
}

TEST_F(Errors, WordsOfEarlierVersionsAreTakenWithAWarning) {
  ASSERT_TRUE(ltm::create_store(path("store")).ok());
  const RunResult now = run_engram({"recover", path("store"), "--out", path("now")});
  EXPECT_EQ(now.exit_code, 0) << now.err;
  EXPECT_THAT(now.err, ::testing::Not(HasSubstr("--out")));
  const RunResult old = run_engram({"recover", path("store"), "--output=" + path("old")});
  EXPECT_EQ(old.exit_code, 0) << old.err;
  EXPECT_THAT(old.err, HasSubstr("'--output' is '--out' now, and is taken until 0.3"));
  EXPECT_TRUE(std::filesystem::exists(path("old/MANIFEST.json")));
  const RunResult quiet = run_engram({"-q", "recover", path("store"), "--output", path("quiet")});
  EXPECT_EQ(quiet.err, "");
  EXPECT_EQ(
      run_engram({"recover", path("store"), "--output", path("a"), "--out", path("b")}).exit_code,
      kWrongUsage);
}

TEST_F(Errors, HelpAndVersionSucceed) {
  EXPECT_EQ(run_engram({"--version"}).exit_code, 0);
  for (const char* command : {"import", "info", "consolidate", "query", "eval", "simulate", "check",
                              "recover", "models"}) {
    const RunResult help = run_engram({command, "--help"});
    EXPECT_EQ(help.exit_code, 0) << command;
    EXPECT_THAT(help.out, HasSubstr("Usage")) << command;
  }
}

TEST_F(Errors, DamagedJournalOfAnEarlierSessionIsReportedAsLoss) {
  {
    // A session that never seals, as one that was killed.
    auto recorder = ltm::Recorder::open(path("store"), {});
    ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
    const auto entity = ltm::MemoryId::parse(kCamera).value();
    for (int i = 1; i <= 3; ++i)
      ASSERT_TRUE(
          recorder->commit({{{entity, time_from_ns(i), {{std::string(500, 'x'), {}}}}}}).ok());
  }
  const std::string journal = path("store/journal/000001.log");
  std::string bytes = read(journal);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
  write(journal, bytes);
  const RunResult next =
      run_engram(import_arguments(make_recording(directory_.path(), 1), path("store")));
  EXPECT_EQ(next.exit_code, kDoneWithLoss) << next.err;
  EXPECT_THAT(next.err, HasSubstr("damaged"));
  const RunResult info = run_engram({"info", path("store"), "--json"});
  const auto json = nlohmann::json::parse(info.out);
  EXPECT_EQ(json.at("damaged_journal_places"), 1);
  // Two of the three survive, and the five that came after.
  EXPECT_EQ(json.at("entities").at(1).at("snapshots"), 7);
}

}  // namespace
}  // namespace engram::cli
