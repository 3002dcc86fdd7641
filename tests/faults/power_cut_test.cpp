// SPDX-License-Identifier: Apache-2.0
// The power goes between any two changes of a session: what was promised is there.
#include <algorithm>
#include <set>

#include "tests/faults/faulty_files.h"
#include "tests/faults/replay.h"
#include "tests/faults/run.h"
#include "tests/faults/verify.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm::faults {
namespace {

/// Runs a session and gives all its changes, in order; what it told is among them.
std::vector<Change> trace_of(const ScratchDirectory& scratch, const SessionOptions& options) {
  const std::filesystem::path directory = scratch / "run";
  std::filesystem::create_directory(directory);
  const Outcome outcome = run_child([&] {
    faulty_files_watch(directory.c_str());
    faulty_files_trace((scratch / "trace").c_str());
    run_session(directory / "store", options, tell_into(directory / "told"));
  });
  EXPECT_TRUE(outcome.is_clean());
  return read_trace(scratch / "trace", directory);
}

bool is_journal(const Change& change) {
  return change.path.parent_path() == "store/journal" && change.record.is_directory == 0;
}

/// What is promised to survive a power cut after the first `count` changes: with `every`, all that
/// was told; else what was told of data that was forced since.
std::vector<Told> promised(const std::vector<Change>& changes, size_t count, bool is_every) {
  std::vector<Told> sure, waiting;
  std::vector<uint64_t> files;  // That the waiting ones were written to.
  uint64_t last_written = 0;
  for (size_t i = 0; i < count; ++i) {
    const Change& change = changes[i];
    if (is_journal(change) && change.record.change == kFileWrite) last_written = change.record.file;
    if (change.path == "told" && change.record.change == kFileWrite) {
      const Told told = told_of(change.data).at(0);
      const bool is_sure = is_every || told.kind != Told::kStored;
      (is_sure ? sure : waiting).push_back(told);
      if (!is_sure) files.push_back(last_written);
    }
    if (!is_journal(change) || change.record.change != kFileSync) continue;
    for (size_t k = 0; k < waiting.size(); ++k)
      if (files[k] == change.record.file) sure.push_back(waiting[k]);
  }
  return sure;
}

struct Case {
  const char* name;
  SessionOptions options;
  bool is_every;
};

class PowerCutTest : public testing::TestWithParam<Case> {};

TEST_P(PowerCutTest, LosesNothingThatWasPromised) {
  const ScratchDirectory scratch;
  const auto changes = trace_of(scratch, GetParam().options);
  ASSERT_GT(changes.size(), 100u);
  Disk disk;
  size_t cuts = 0, promises = 0;
  const size_t stride = stride_or_all(13);
  for (size_t k = 0; k <= changes.size(); ++k) {
    if (k > 0 && changes[k - 1].path != "told") disk.apply(changes[k - 1]);
    if (k % stride != 0 && k != changes.size()) continue;
    const auto told = promised(changes, k, GetParam().is_every);
    promises = told.size();
    for (int cut = 0; cut < kPowerCuts; ++cut, ++cuts) {
      SCOPED_TRACE(fmt::format("after change {} of {} ({} '{}'), cut {}", k, changes.size(),
                               k == 0 ? 0 : changes[k - 1].record.change,
                               k == 0 ? "" : changes[k - 1].path.string(), cut));
      const std::filesystem::path after = scratch / "after";
      std::filesystem::create_directory(after);
      disk.write(after, static_cast<PowerCut>(cut), static_cast<uint32_t>(k));
      EXPECT_THAT(problems_of(after / "store", told), testing::IsEmpty());
      std::filesystem::remove_all(after);
    }
    if (HasFailure()) break;
  }
  EXPECT_GT(promises, 20u);
  fmt::print("{} changes, {} power cuts, {} promises at the end\n", changes.size(), cuts, promises);
}

INSTANTIATE_TEST_SUITE_P(
    Durabilities, PowerCutTest,
    testing::Values(
        Case{"Every", {.store = {.durability = Durability::kEvery, .min_free_bytes = 0}}, true},
        Case{"Interval",
             {.store = {.durability = Durability::kInterval,
                        .sync_interval = std::chrono::milliseconds(5),
                        .seal_bytes = 4000,
                        .min_free_bytes = 0},
              .pause_us = 1000},
             false}),
    [](const testing::TestParamInfo<Case>& param) { return param.param.name; });

TEST(PowerCut, ADiskKeepsOnlyWhatItWasForcedTo) {
  const auto change = [](int kind, const char* path, std::string data = "",
                         bool is_directory = false, const char* second = "") {
    Change made;
    made.record.change = static_cast<uint32_t>(kind);
    made.record.file = 7;
    made.record.is_directory = is_directory ? 1 : 0;
    made.path = path;
    made.second = second;
    made.data = std::move(data);
    return made;
  };
  Disk disk;
  disk.apply(change(kFileCreate, "a"));
  disk.apply(change(kFileWrite, "a", "abcd"));
  const auto names_after = [&disk](PowerCut cut) {
    const ScratchDirectory scratch;
    disk.write(scratch.path(), cut, 1);
    std::set<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(scratch.path()))
      found.insert(fmt::format("{} {}", entry.path().filename().string(), entry.file_size()));
    return found;
  };
  using testing::ElementsAre;
  EXPECT_THAT(names_after(PowerCut::kNothing), ElementsAre());
  EXPECT_THAT(names_after(PowerCut::kNamesOnly), ElementsAre("a 0"));
  EXPECT_THAT(names_after(PowerCut::kTorn), ElementsAre("a 2"));
  disk.apply(change(kFileSync, "a"));
  EXPECT_THAT(names_after(PowerCut::kNothing), ElementsAre());
  EXPECT_THAT(names_after(PowerCut::kNamesOnly), ElementsAre("a 4"));
  disk.apply(change(kFileSync, "", "", true));
  EXPECT_THAT(names_after(PowerCut::kNothing), ElementsAre("a 4"));
  disk.apply(change(kFileRename, "a", "", false, "b"));
  EXPECT_THAT(names_after(PowerCut::kNothing), ElementsAre("a 4"));
  EXPECT_THAT(names_after(PowerCut::kTorn), ElementsAre("b 4"));
}

}  // namespace
}  // namespace engram::ltm::faults
