// SPDX-License-Identifier: Apache-2.0
// Ctrl-C and SIGTERM at ten moments of each command: it ends soon, says so, and nothing is half
// done.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using WallClock = std::chrono::steady_clock;

constexpr int kMoments = 6;
/// A second is what is promised; machines that run tests are busy.
constexpr auto kSoon = std::chrono::seconds(6);
/// Signals come within so much of a command.
constexpr auto kLongest = std::chrono::milliseconds(1500);

class Interrupt : public ::testing::TestWithParam<std::vector<std::string>> {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<ScratchDirectory>();
    const Recording recording = make_recording(folder_->path(), 10);
    made_ = folder_->path() / "made.engram";
    // Two recordings: crossval leaves one of them out.
    for (const char* start : {"2022-02-18 13:00:00", "2022-02-19 13:00:00"})
      ASSERT_EQ(run_engram(import_arguments(recording, made_, start)).exit_code, 0);
    ASSERT_EQ(run_engram({"consolidate", made_, "--representation", "video", "--training", "1s"})
                  .exit_code,
              0);
    make_audit_log();
    ASSERT_EQ(
        run_engram({"export", made_, "--to", "vault", "-o", vault(), "--keys", keys()}).exit_code,
        0);
  }

  static std::string vault() { return folder_->path() / "made.vault"; }
  static std::string keys() { return folder_->path() / "made.keys"; }

  /// A log that no server wrote, with keys to make for each of its records, and for gaps.
  static void make_audit_log() {
    const std::string log = folder_->path() / "audit.log";
    ASSERT_EQ(run_engram({"audit", "create", log}).exit_code, 0);
    std::ofstream file(log);
    const std::string zeros(64, '0');
    for (int i = 0; i < 400'000; ++i)
      file << R"({"record":)" << i + i / 1000 * 1000 << R"(,"before":")" << zeros << R"(","seal":")"
           << zeros << "\"}\n";
  }

  static void TearDownTestSuite() { folder_.reset(); }

  /// The arguments of a command, for a store of its own.
  std::vector<std::string> arguments(const std::string& store, int round) const {
    std::vector<std::string> all;
    for (std::string word : GetParam()) {
      if (word == "STORE") word = store;
      if (word == "NEW") word = store + ".new" + std::to_string(round);
      if (word == "VIDEO") word = folder_->path() / "scene.mp4";
      if (word == "LOG") word = folder_->path() / "audit.log";
      if (word == "VAULT") word = vault();
      if (word == "KEYS") word = keys();
      if (word == "NEW_KEYS") word = store + ".keys" + std::to_string(round);
      all.push_back(std::move(word));
    }
    return all;
  }

  /// Whether the command changes its store.
  [[nodiscard]] static bool writes() {
    const std::string& command = GetParam().front();
    return command == "import" || command == "consolidate" || command == "forget" ||
           command == "redact" || command == "compact";
  }

  static std::unique_ptr<ScratchDirectory> folder_;
  static std::string made_;
};

std::unique_ptr<ScratchDirectory> Interrupt::folder_;
std::string Interrupt::made_;

TEST_P(Interrupt, EndsTheCommandSoonAndLeavesTheStoreWhole) {
  const ScratchDirectory scratch;
  const std::string store = scratch.path() / "robot.engram";
  const auto renew = [&store] {
    std::filesystem::remove_all(store);
    std::filesystem::copy(made_, store, std::filesystem::copy_options::recursive);
  };
  renew();
  const auto begin = WallClock::now();
  const RunResult whole = run_engram(arguments(store, -1));
  // Something is wrong with that log.
  const int done = GetParam().front() == "audit" ? 3 : 0;
  EXPECT_EQ(whole.exit_code, done) << whole.err;
  const auto lasts = std::min<WallClock::duration>(WallClock::now() - begin, kLongest);
  int interrupted = 0;
  for (int round = 0; round < kMoments; ++round) {
    SCOPED_TRACE(round);
    if (writes()) renew();
    RunningEngram running(arguments(store, round));
    std::this_thread::sleep_for(lasts * (round + 1) / (kMoments + 1));
    const auto told = WallClock::now();
    const int signal = round % 2 == 0 ? SIGINT : SIGTERM;
    const RunResult result = running.end(signal);
    EXPECT_LT(WallClock::now() - told, kSoon);
    // Before it is set up, the signal itself ends it; or it was done already.
    EXPECT_THAT(result.exit_code, ::testing::AnyOf(128 + signal, -signal, done)) << result.err;
    interrupted += result.exit_code != done ? 1 : 0;
    if (!writes() && round + 1 < kMoments) continue;
    const RunResult check = run_engram({"check", store});
    EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
  }
  EXPECT_GT(interrupted, 1);
}

class InterruptOfClients : public Interrupt {};

/// Commands that ask a running server, each with a store and a server of its own.
TEST_P(InterruptOfClients, EndsTheCommandSoonAndTheServerGoesOn) {
  const ScratchDirectory scratch;
  const std::string store = scratch.path() / "robot.engram";
  const std::string endpoint = "unix:" + (scratch.path() / "s").string();
  std::vector<std::string> command = GetParam();
  std::ranges::replace(command, "ENDPOINT", endpoint);
  WallClock::duration lasts = kLongest;
  int interrupted = 0;
  for (int round = -1; round < kMoments; ++round) {
    SCOPED_TRACE(round);
    std::filesystem::remove_all(store);
    std::filesystem::copy(made_, store, std::filesystem::copy_options::recursive);
    RunningEngram server({"serve", store, "--no-system-state", "--listen", endpoint});
    ASSERT_TRUE(server.wait_for("listens at"));
    const auto begin = WallClock::now();
    RunningEngram running(command);
    if (round < 0) {
      const RunResult whole = running.end(0);
      EXPECT_EQ(whole.exit_code, 0) << whole.err;
      lasts = std::min<WallClock::duration>(WallClock::now() - begin, kLongest);
    } else {
      std::this_thread::sleep_for(lasts * (round + 1) / (kMoments + 1));
      const auto told = WallClock::now();
      const int signal = round % 2 == 0 ? SIGINT : SIGTERM;
      const RunResult result = running.end(signal);
      EXPECT_LT(WallClock::now() - told, kSoon);
      EXPECT_THAT(result.exit_code, ::testing::AnyOf(128 + signal, -signal, 0)) << result.err;
      interrupted += result.exit_code != 0 ? 1 : 0;
    }
    // The same command finds all that it names, or carries on; it may find nothing any more.
    RunResult again = run_engram(command);
    // A server that was told to stop ends the step that it is in.
    for (int i = 0; i < 60 && again.err.find("is forgetting already") != std::string::npos; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
      again = run_engram(command);
    }
    EXPECT_TRUE(again.exit_code == 0 || again.err.find("names no snapshot") != std::string::npos)
        << again.err;
    EXPECT_EQ(server.end(SIGTERM).exit_code, 0);
    const RunResult check = run_engram({"check", store});
    EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
  }
  EXPECT_GT(interrupted, 1);
}

std::string test_name(const std::vector<std::string>& command) {
  std::string name = command.front();
  for (const std::string& word : command)
    if (word == "VAULT" || word == "NEW_KEYS")
      name += "_vault";
    else if (word == "--jobs")
      name += "_in_two_processes";
    else if (word == "--dry-run")
      name += "_dry_run";
    else if (word == "--erase")
      name += "_erase";
  return name;
}

INSTANTIATE_TEST_SUITE_P(Commands, InterruptOfClients,
                         ::testing::ValuesIn(std::vector<std::vector<std::string>>{
                             {"query", "--server", "ENDPOINT", "Vision @ all", "--json"},
                             {"forget", "--server", "ENDPOINT", "Vision @ all", "--yes"},
                             {"forget", "--server", "ENDPOINT", "Vision @ latest:25", "--erase",
                              "--yes"},
                         }),
                         [](const auto& command) { return test_name(command.param); });

INSTANTIATE_TEST_SUITE_P(
    Commands, Interrupt,
    ::testing::ValuesIn(std::vector<std::vector<std::string>>{
        {"info", "STORE"},
        {"ls", "STORE"},
        {"query", "STORE", "Vision @ all", "--json"},
        {"predict", "STORE", "Vision/RGB/head/cam", "--compare"},
        {"models", "STORE"},
        {"check", "STORE", "--deep"},
        {"reflect", "STORE", "--images"},
        {"eval", "STORE"},
        {"export", "STORE", "Vision @ all", "--to", "mp4", "-o", "NEW"},
        {"import", "--video", "VIDEO", "--entity", "Vision/RGB/other/cam", "STORE"},
        {"consolidate", "STORE", "--force", "--training", "3s"},
        {"consolidate", "STORE", "--force", "--training", "3s", "--jobs", "2"},
        {"crossval", "STORE", "--entity", "Vision/RGB/head/cam", "--training", "2s"},
        {"augment", "STORE", "--out", "NEW"},
        {"forget", "STORE", "Vision @ all", "--dry-run"},
        {"forget", "STORE", "Vision @ all", "--yes"},
        {"forget", "STORE", "Vision @ until:2022-02-18T13:00:05Z", "--erase", "--yes"},
        {"redact", "STORE", "Vision @ latest:25", "--detector", "people", "--dry-run"},
        {"redact", "STORE", "Vision @ latest:25", "--detector", "people", "--yes"},
        {"compact", "STORE"},
        {"recover", "STORE", "-o", "NEW"},
        {"audit", "verify", "LOG"},
        {"export", "STORE", "--to", "vault", "-o", "NEW", "--keys", "NEW_KEYS"},
        {"import", "--from", "VAULT", "--keys", "KEYS", "NEW"},
        {"vault", "verify", "VAULT", "--keys", "KEYS"},
    }),
    [](const auto& command) { return test_name(command.param); });

}  // namespace
}  // namespace engram::cli
