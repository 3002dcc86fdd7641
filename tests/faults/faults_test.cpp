// SPDX-License-Identifier: Apache-2.0
// Every change of a session fails once, in every way that it can: what was acknowledged is there.
#include "tests/faults/faulty_files.h"

#include <algorithm>
#include <map>

#include "tests/faults/replay.h"
#include "tests/faults/run.h"
#include "tests/faults/verify.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm::faults {
namespace {

/// No thread but that of the session changes files: call n is the same change in every run.
const SessionOptions kOptions{.store = {.durability = Durability::kEvery, .min_free_bytes = 0}};

struct SessionRun {
  Outcome outcome;
  std::vector<Told> told;
  int64_t calls = 0;

  [[nodiscard]] bool has(Told::Kind kind) const {
    return std::ranges::any_of(told, [kind](const Told& each) { return each.kind == kind; });
  }
};

/// Runs a session in `directory` with one fault.
SessionRun run_with(const std::filesystem::path& directory, int64_t call, int kind,
                    const std::filesystem::path& trace = {}) {
  std::filesystem::create_directory(directory);
  const std::filesystem::path counted = directory.string() + ".calls";
  SessionRun run;
  run.outcome = run_child([&] {
    faulty_files_watch(directory.c_str());
    faulty_files_fail(call, kind);
    if (!trace.empty()) faulty_files_trace(trace.c_str());
    run_session(directory / "store", kOptions, tell_into(directory / "told"));
    std::ofstream(counted) << faulty_files_calls();
  });
  run.told = read_told(directory / "told");
  std::ifstream(counted) >> run.calls;
  return run;
}

/// The ways in which a change of this kind can fail.
std::vector<int> faults_of(uint32_t change) {
  switch (change) {
    case kFileWrite:
      return {kFaultShort, kFaultNoSpace, kFaultFull, kFaultBroken, kFaultDead};
    case kFileCreate:
    case kFileRename:
    case kFileMkdir:
      return {kFaultNoSpace, kFaultFull, kFaultBroken, kFaultDead};
    default:
      return {kFaultBroken, kFaultDead};
  }
}

struct Call {
  uint32_t change = kFileUnlink;  ///< Those that are not in the trace remove what is not there.
  /// Forces to the disk what was appended to a journal right before.
  bool is_acknowledging = false;
};

std::map<int64_t, Call> calls_of(const std::vector<Change>& trace) {
  std::map<int64_t, Call> calls;
  const Change* last = nullptr;
  for (const Change& change : trace) {
    if (change.record.call == 0) continue;
    calls[change.record.call] = {
        change.record.change, change.record.change == kFileSync && last != nullptr &&
                                  last->path == change.path && last->record.change == kFileWrite &&
                                  last->record.offset > 0 &&
                                  change.path.parent_path() == "store/journal"};
    last = &change;
  }
  return calls;
}

TEST(FaultyFiles, ASessionWithoutFaultsStoresEverything) {
  const ScratchDirectory scratch;
  const SessionRun run = run_with(scratch / "run", 0, kFaultNone);
  ASSERT_TRUE(run.outcome.is_clean());
  EXPECT_FALSE(run.has(Told::kFailed));
  EXPECT_TRUE(run.has(Told::kFinished));
  EXPECT_TRUE(run.has(Told::kDropping));
  EXPECT_THAT(problems_of(scratch / "run/store", run.told), testing::IsEmpty());
}

TEST(FaultyFiles, TheVerifierFindsWhatIsNotThere) {
  const ScratchDirectory scratch;
  SessionRun run = run_with(scratch / "run", 0, kFaultNone);
  run.told.push_back({Told::kStored, 0, 1000, 0});
  EXPECT_THAT(problems_of(scratch / "run/store", run.told), testing::Not(testing::IsEmpty()));
  run.told.back() = {Told::kStored, 1, 1, 1};
  EXPECT_THAT(problems_of(scratch / "run/store", run.told), testing::Not(testing::IsEmpty()));
}

TEST(FaultyFiles, LosesNothingAcknowledgedWhicheverCallFails) {
  const ScratchDirectory scratch;
  const SessionRun whole = run_with(scratch / "whole", 0, kFaultNone, scratch / "trace");
  ASSERT_TRUE(whole.outcome.is_clean());
  auto calls = calls_of(read_trace(scratch / "trace", scratch / "whole"));
  ASSERT_GT(whole.calls, 100);
  ASSERT_GT(
      std::ranges::count_if(calls, [](const auto& each) { return each.second.is_acknowledging; }),
      10);
  size_t runs = 0, told_of_errors = 0;
  const auto stride = static_cast<int64_t>(stride_or_all(17));
  for (int64_t call = 1; call <= whole.calls; call += stride) {
    const Call& made = calls[call];
    for (const int kind : faults_of(made.change)) {
      SCOPED_TRACE(fmt::format("call {} (change {}), fault {}", call, made.change, kind));
      const std::filesystem::path directory = scratch / fmt::format("{}-{}", call, kind);
      const SessionRun run = run_with(directory, call, kind);
      EXPECT_TRUE(run.outcome.is_clean())
          << "exit code " << run.outcome.exit_code << ", signal " << run.outcome.signal;
      // A short write is no error. Sealing may be tried again by itself; all else is told.
      EXPECT_TRUE(run.has(Told::kFailed) || run.has(Told::kFinished));
      EXPECT_FALSE(run.has(Told::kFailed) && kind == kFaultShort);
      EXPECT_TRUE(run.has(Told::kFailed) || !made.is_acknowledging || kind != kFaultBroken);
      EXPECT_THAT(problems_of(directory / "store", run.told), testing::IsEmpty());
      ++runs;
      told_of_errors += run.has(Told::kFailed) ? 1 : 0;
      std::filesystem::remove_all(directory);
    }
  }
  fmt::print("{} calls, {} runs with a fault, {} told of errors\n", whole.calls, runs,
             told_of_errors);
}

}  // namespace
}  // namespace engram::ltm::faults
